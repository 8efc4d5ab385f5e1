"""Models of several outputs of the same record, in one object and one file."""

from __future__ import annotations

import io
import os
import re
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from hysid import _hysid
from hysid._arguments import truth
from hysid._data import is_record_list, outputs_of
from hysid._results import Errors
from hysid._tables import is_of_pandas
from hysid.model import Model

__all__ = ["ModelSet", "fitted_set"]

FIRST = ("hysid-models.txt", "Models of Hysid: a file for each output, which hysid.Model.load and the program hysid read.\n")
"""Name and content of the first file of an archive, by which Hysid recognises its own."""

LONGEST = 1 << 30
"""Bytes of an archive's files together, at most."""


class ModelSet(Mapping[str, Model]):
    """Models of several outputs, one for each, by the names of the outputs: ``models["force_kN"]``.

    `hysid.fit` returns it for a `y` of several columns. Each model is fitted by itself to its own output.

    Parameters
    ----------
    models : sequence of Model
        Models with the same inputs, each of another output.

    Examples
    --------
    >>> import numpy as np
    >>> import hysid
    >>> x = np.linspace(0, 6, 600) * np.sin(np.linspace(0, 60, 600))
    >>> outputs = {"force": hysid.operators.stop(x, r=1.0), "slip": hysid.operators.play(x, r=1.0)}
    >>> models = hysid.fit(x, outputs, model="masing")
    >>> list(models), models.simulate(x).shape
    (['force', 'slip'], (600, 2))
    """

    def __init__(self, models: Sequence[Model]) -> None:
        self._models = {model.output: model for model in models}
        if not models or len(self._models) < len(models):
            raise ValueError("models: at least one is needed, and each of another output")
        if any(model.inputs != models[0].inputs for model in models):
            raise ValueError("models: all need the same inputs")

    def __getitem__(self, output: str) -> Model:
        if output not in self._models:
            raise KeyError(f"there is no output {output!r}: the outputs are {', '.join(self._models)}")
        return self._models[output]

    def __iter__(self) -> Iterator[str]:
        return iter(self._models)

    def __len__(self) -> int:
        return len(self._models)

    def __repr__(self) -> str:
        return "\n".join(map(repr, self._models.values()))

    def simulate(self, x: Any, time: Any = None, rate: Any = None, records: Any = None, **options: Any) -> Any:
        """Simulate all outputs.

        Parameters
        ----------
        x, time, rate, records : array
            As of `hysid.Model.simulate`.
        **options
            `initial_state` and `same_units`, as of `hysid.Model.simulate`.

        Returns
        -------
        array of shape (n, outputs)
            A column for each output. A DataFrame for an object of pandas; a dict of outputs for objects of polars and xarray;
            a list of these for a list of records.
        """
        found = [model.simulate(x, time, rate, records, **options) for model in self._models.values()]
        return [self._together(parts) for parts in zip(*found)] if is_record_list(x) else self._together(found)

    def _together(self, outputs: Sequence[Any]) -> Any:
        if all(isinstance(output, np.ndarray) for output in outputs):
            return np.column_stack(outputs)
        if is_of_pandas(outputs[0]):
            import pandas

            return pandas.concat(outputs, axis="columns")
        return dict(zip(self, outputs))

    def evaluate(
        self, x: Any, y: Any, time: Any = None, rate: Any = None, records: Any = None, **options: Any
    ) -> dict[str, Errors]:
        """Compute the errors of a free run of each output.

        Parameters
        ----------
        x, time, rate, records : array
            As of `hysid.Model.evaluate`.
        y : array of shape (n, outputs), or table
            The measured outputs, as `hysid.fit` takes them: a table by the names of its columns, an array by their order.
        **options
            Further options of `hysid.Model.evaluate`.

        Returns
        -------
        dict of Errors
            The errors, by the names of the outputs.
        """
        several = outputs_of(x, y)
        if several is None:
            raise ValueError(f"y: {len(self)} outputs are needed: a table or an array with a column for each")
        x, columns = several
        if set(columns) != set(self):
            is_named = list(columns) != [f"y{place + 1}" for place in range(len(columns))]
            if is_named or len(columns) != len(self):
                raise ValueError(f"y has the outputs {', '.join(columns)}, and the models have {', '.join(self)}")
            columns = dict(zip(self, columns.values()))
        pairs = self._models.items()
        return {name: model.evaluate(x, columns[name], time, rate, records, **options) for name, model in pairs}

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write all models as one file: a zip archive with a model file for each output.

        As `hysid.Model.save`, it leaves an old file unchanged if writing fails, and keeps other content as ``NAME.bak``.

        Parameters
        ----------
        path : path
            The file, such as ``"models.zip"``. Its members can be read by the program `hysid`.
        force : bool
            Replace a file even if it is no such archive of Hysid.

        Raises
        ------
        FileExistsError
            The file exists, is no such archive of Hysid, and `force` is False.
        OSError
            The file cannot be written.
        """
        content, beginning = io.BytesIO(), 0
        with zipfile.ZipFile(content, "w") as archive:
            for name, text in (FIRST, *self._files()):
                archive.writestr(zipfile.ZipInfo(name), text)
                beginning = beginning or content.tell()
        _hysid.write_models(path, content.getvalue(), beginning, truth("force", force))

    def _files(self) -> Iterator[tuple[str, str]]:
        for place, (output, model) in enumerate(self._models.items(), 1):
            yield f"{place}-{re.sub(r'[^A-Za-z0-9]+', '_', output).strip('_')}.json", model.to_json()

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> ModelSet:
        """Read a file that `save` wrote.

        Parameters
        ----------
        path : path
            The file.

        Returns
        -------
        ModelSet
            The models.

        Raises
        ------
        ValueError
            The file is damaged, or not of several models.
        """
        try:
            with zipfile.ZipFile(path) as archive:
                files = archive.infolist()
                if [file.filename for file in files[:1]] != [FIRST[0]]:
                    raise ValueError("it is no archive of models that ModelSet.save wrote")
                if sum(file.file_size for file in files) > LONGEST:
                    raise ValueError("it is larger than 1 GiB")
                return cls([Model.from_json(archive.read(file).decode()) for file in files[1:]])
        except (ValueError, zipfile.BadZipFile, NotImplementedError, RuntimeError) as error:
            raise ValueError(f"{os.fspath(path)}: {error}") from None


def fitted_set(x: Any, y: Any, fit: Callable[[Any, Any], Model]) -> ModelSet | None:
    """A model of each output if `y` has several; None for one output."""
    several = outputs_of(x, y)
    if several is None:
        return None
    x, columns = several
    return ModelSet([fit(x, column) for column in columns.values()])
