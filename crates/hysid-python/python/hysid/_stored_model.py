"""A model as its file describes it: the file itself, its properties, and its summary."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from functools import cached_property
from typing import Any, TypeVar

from hysid import _hysid
from hysid._arguments import pair, real, truth, whole
from hysid._results import Errors, Member
from hysid._summary import Summary, error_in_words
from hysid._warning import warn

__all__ = ["StoredModel"]

Self = TypeVar("Self", bound="StoredModel")


class StoredModel:
    """Content of a model file, without running the model."""

    def __init__(self, native: _hysid.Model) -> None:
        self._native = native

    # Files

    @classmethod
    def load(cls: type[Self], path: str | os.PathLike[str]) -> Self:
        """Read a model file, of Python or of the program `hysid`.

        Parameters
        ----------
        path : path
            The file.

        Returns
        -------
        Model
            The model.

        Raises
        ------
        ValueError
            The file is damaged, of a later version, or not a model file.
        """
        with open(path, "rb") as file:
            content = file.read()
        try:
            if content.startswith(b"PK"):
                raise ValueError("an archive of several models is read by hysid.ModelSet.load")
            return cls.from_json(content.decode(errors="replace"))
        except ValueError as error:
            raise ValueError(f"{os.fspath(path)}: {error}") from None

    @classmethod
    def from_json(cls: type[Self], text: str) -> Self:
        """Read the text of a model file.

        Parameters
        ----------
        text : str
            What `to_json` gave.

        Returns
        -------
        Model
            The model.
        """
        if not isinstance(text, str):
            raise TypeError(f"text: the text of a model file is needed, not {type(text).__name__}")
        return cls(_hysid.Model.from_json(text))

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the model file.

        A failed write leaves an old file unchanged. An old model file with other content is kept as ``NAME.bak``.
        Links are followed, permissions are kept, and pipes and devices are written to directly.

        Parameters
        ----------
        path : path
            The file; it can be read by the program `hysid` too.
        force : bool
            Replace a file even if it is not a model file of Hysid.

        Raises
        ------
        FileExistsError
            The file exists, is not a model file of Hysid, and `force` is False.
        OSError
            The file cannot be written.
        """
        self._native.save(path, truth("force", force))

    def export(
        self,
        to: str,
        folder: str | os.PathLike[str],
        *,
        name: str | None = None,
        precision: str = "f64",
        rate: str = "backward",
        fmi: int = 3,
        band: float | None = None,
        of_ten: int = 5,
        inverse: bool = False,
        limits: tuple[float, float] | None = None,
        slew: float | None = None,
        force: bool = False,
    ) -> list[str]:
        """Write the model as source code for other programs, with tests and test vectors.

        The folder appears whole or not at all.

        Parameters
        ----------
        to : {"abaqus", "c", "fmu", "matlab", "onnx", "opensees", "python"}
            Where the model is to run.
        folder : path
            The folder of the export. One that is there already is replaced only if Hysid wrote all that is in it.
        name : str, optional
            Identifier with which all names of the export begin. By default, the name of the folder.
        precision : {"f64", "f32"}
            Precision of the arithmetic.
        rate : {"backward", "argument"}
            How the model gets the rate of its first input: by backward differences, from the time step, or as an
            argument of each step. A model without rate ignores it.
        fmi : {3, 2}
            Version of the Functional Mock-up Interface of `to="fmu"`.
        band : float, optional
            Also compute half the width of the prediction band that contains this share of the rows (0.5 to 0.99).
        of_ten : int
            The band contains that share, or more, in so many of ten data sets (5 to 9).
        inverse : bool
            Also export the inverse, which gives the first input for a wanted output (``to="c"`` or ``"fmu"``).
        limits : (float, float), optional
            Lowest and highest input of the inverse, in its unit. By default, the trained range.
        slew : float, optional
            Largest change of the input of the inverse in a unit of time.
        force : bool
            Replace a folder even if Hysid did not write it, with all that is in it.

        Returns
        -------
        list of str
            The files, by their paths in the folder.

        Raises
        ------
        ValueError
            A target, precision, rate or name that cannot be used; an inverse that the target does not have; limits that
            cannot be used; a model that cannot be exported.
        FileExistsError
            The folder has other files, and `force` is False.
        OSError
            The folder cannot be written.
        """
        for what, given, known in (
            ("precision", precision, ("f64", "f32")),
            ("rate", rate, ("backward", "argument")),
            ("fmi", fmi, (3, 2)),
        ):
            if given not in known:
                raise ValueError(f"{what} {given!r}: it is {' or '.join(map(repr, known))}")
        if name is None:
            name = re.sub(r"\W", "_", os.path.basename(os.path.normpath(folder)), flags=re.ASCII)
        level = None if band is None else (real("band", band), whole("of_ten", of_ten))
        if limits is not None:
            limits = pair("limits", limits)
        if slew is not None:
            slew = real("slew", slew)
        inverse = truth("inverse", inverse)
        if not inverse and (limits, slew) != (None, None):
            raise ValueError("limits and slew are for the input of an inverse: add inverse=True")
        force = truth("force", force)
        files, note = self._native.export(
            to, folder, name, precision, rate, fmi, level, inverse, limits, slew, force
        )
        warn([] if note is None else [note])
        return files

    def to_json(self) -> str:
        """Give the text of the model file.

        Returns
        -------
        str
            JSON with a version and a checksum.
        """
        return self._native.to_json()

    # Properties

    @cached_property
    def description(self) -> dict[str, Any]:
        """Content of the model file."""
        described: dict[str, Any] = json.loads(self.to_json())
        return described

    @property
    def name(self) -> str:
        """Name of the model."""
        return str(self.description["model"])

    @property
    def inputs(self) -> list[str]:
        """Names of the inputs."""
        return list(self.description["columns"]["inputs"])

    @property
    def output(self) -> str:
        """Name of the output."""
        return str(self.description["columns"]["output"])

    @property
    def rate(self) -> str | None:
        """Method for the rate of the first input."""
        rate: str | None = self.description["rate"]
        return rate

    @property
    def parameters(self) -> int:
        """Number of fitted parameters."""
        return self._native.parameters()

    @property
    def needs_time(self) -> bool:
        """Whether the model needs time stamps."""
        return self._native.needs_time()

    @cached_property
    def members(self) -> tuple[Member, ...]:
        """Members of an ensemble; empty for a single model."""
        ensemble = self.description.get("ensemble")
        if ensemble is None:
            return ()
        models = [member["model"] for member in ensemble["members"]]
        found = sorted(_members(ensemble["group"], (), 1.0, 1.0), key=lambda one: one[0])
        # The innermost group is the candidate, whose kind the selection tells.
        candidates = (self.description["training"].get("selection") or {}).get("candidates", [])
        kinds = {one["name"]: one["kind"] for one in candidates}
        return tuple(
            Member(path[-1], kinds.get(path[-1], path[-1]), models[place], inside, outside)
            for place, path, inside, outside in found
        )

    @property
    def has_band(self) -> bool:
        """Whether the model has a prediction band, see `predict`."""
        return "band" in self.description

    @property
    def train(self) -> Errors:
        """Errors on the training data."""
        return Errors(**self.description["training"]["train"])

    @property
    def validation(self) -> Errors | None:
        """Errors on held-out data; None if no data were held out."""
        errors = self.description["training"]["validation"]
        return None if errors is None else Errors(**errors)

    @property
    def train_after_warm_up(self) -> Errors | None:
        """As `train`, without the rows of the warm-up; None for a model without one."""
        errors = self.description["training"].get("train_after_warm_up")
        return None if errors is None else Errors(**errors)

    @property
    def warm_up(self) -> int:
        """Rows at the beginning of each record that drove the memory and were not trained on."""
        return self._native.warm_up()

    @property
    def notes(self) -> list[str]:
        """Notes on the limits of this model, in sentences."""
        return self._native.notes()

    @property
    def termination(self) -> str:
        """Why the last training run ended."""
        return str(self.description["training"]["termination"])

    # Comparison and display

    def __eq__(self, other: object) -> bool:
        return isinstance(other, StoredModel) and self.to_json() == other.to_json()

    def __hash__(self) -> int:
        return hash(self.to_json())

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self).from_json, (self.to_json(),)

    def __repr__(self) -> str:
        inputs = ", ".join(self.inputs)
        name = f"{self.name} of {len(self.members)}" if self.members else self.name
        errors = [f"{error_in_words(self.train)} in training"]
        if self.validation is not None:
            errors.append(f"{error_in_words(self.validation)} held out")
        return f"<hysid.Model {name}: {inputs} -> {self.output}, {self.parameters} parameters, RMSE {', '.join(errors)}>"

    def summary(self) -> Summary:
        """Give what the model is, its errors and its parameters, to print or to display in a notebook.

        Returns
        -------
        Summary
            ``print(model.summary())`` prints it as text.

        Examples
        --------
        >>> import hysid
        >>> train, _ = hysid.specimen("terfenol-rod").data()
        >>> model = hysid.fit(train.x, train.y, model="masing", thresholds=[0.5, 1.0])
        >>> "RMSE of y" in str(model.summary())
        True
        """
        return Summary(self._facts(), self._errors(), self._parts(), self.notes)

    def _facts(self) -> list[tuple[str, str]]:
        """Description in words."""
        rate = "" if self.rate is None else f", rate by {self.rate} differences"
        if self.rate in ("given", "savitzky-golay"):
            rate = f", rate: {self.rate}"
        ranges = self.description["trained_ranges"]["inputs"]
        inputs = ", ".join(
            f"{_hysid.axis_label(name)} from {low:.4g} to {high:.4g}" for name, (low, high) in zip(self.inputs, ranges)
        )
        facts = [
            ("model", f"{self.name}: {self._kind()}"),
            ("input", f"{inputs}{rate}"),
            ("output", _hysid.axis_label(self.output)),
            ("parameters", str(self.parameters)),
        ]
        facts += zip(("chosen", "why"), self._native.selection() or ())
        if not self.members:
            facts.append(("training", self.termination))
        if self.description["training"].get("weighted"):
            facts.append(("weights", "of rows, in the fit; errors count all rows alike"))
        return facts

    def _kind(self) -> str:
        if self.members:
            return f"ensemble of {len(self.members)} members"
        network = self.description.get("network")
        if network is None:
            return "classical law"
        memory, hidden = network["memory"], len((network.get("readout") or {}).get("hidden") or [])
        relaxation = len(memory.get("relaxation") or [])
        parts = [(len(memory["stops"]), "stops"), (hidden, "tanh neurons"), (relaxation, "relaxation neurons")]
        return "network of " + ", ".join(f"{count} {what}" for count, what in parts if count)

    def _errors(self) -> list[tuple[str, Errors]]:
        """Errors by the data that they are of."""
        named = [("training", self.train), ("after warm-up", self.train_after_warm_up), ("held out", self.validation)]
        return [(name, errors) for name, errors in named if errors is not None]

    def _parts(self) -> tuple[list[str], list[list[str]]] | None:
        """Heading and rows: the members of an ensemble, or the parameters of a law."""
        if self.members:
            members = sorted(self.members, key=lambda member: -member.share)
            weights = [[f"{100 * member.share:.3g}", f"{100 * member.share_outside:.3g}"] for member in members]
            rows = [[member.name, *weight] for member, weight in zip(members, weights)]
            return ["member", "weight, %", "weight outside the trained range, %"], rows
        parameters = self._native.law_parameters()
        if parameters is None:
            return None
        rows = [[symbol, f"{value:.5g}", unit, meaning] for symbol, value, unit, meaning in parameters]
        return ["parameter", "value", "unit", "meaning"], rows

    def _repr_html_(self) -> str:
        return self.summary()._repr_html_()


def _members(
    group: dict[str, Any], above: tuple[str, ...], inside: float, outside: float
) -> Iterator[tuple[int, tuple[str, ...], float, float]]:
    """Index of each member of a group, the names of its groups, and its weights."""
    path = (*above, group["name"])
    sums = [sum(voice["weights"][where] for voice in group["voices"]) for where in ("inside", "outside")]
    for voice in group["voices"]:
        weights, ((kind, who),) = voice["weights"], voice["who"].items()
        shares = (inside * weights["inside"] / sums[0], outside * weights["outside"] / sums[1])
        if kind == "member":
            yield who, path, *shares
        else:
            yield from _members(who, path, *shares)
