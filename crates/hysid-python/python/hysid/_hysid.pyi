import os
from collections.abc import Callable, Sequence
from typing import final

import numpy as np

from hysid._options import ModelName

__all__ = [
    "Dataset",
    "Model",
    "FitSpec",
    "Inverse",
    "Plan",
    "ProgressLine",
    "RecordState",
    "Stepper",
    "Tracking",
    "__version__",
    "axis_label",
    "compare",
    "cycles",
    "deteriorating_stop",
    "diagnose",
    "errors_text",
    "figure_label",
    "figure_names",
    "folds",
    "identify",
    "law",
    "level_figure_names",
    "model_names",
    "name_and_unit",
    "option_names",
    "plan",
    "play",
    "relaxation",
    "relay",
    "restoring_force",
    "specimen",
    "specimens",
    "stop",
    "unit_factor",
    "validate",
    "write_models",
]

__version__: str

_Column = np.ndarray
_Names = tuple[str | None, list[str], str | None, str]
_Record = tuple[str, _Column | None, list[_Column], _Column | None, _Column]

@final
class Dataset:
    def __new__(cls, names: _Names, records: list[_Record], weights: list[_Column] | None = None) -> Dataset: ...
    def names(self) -> _Names: ...
    def records(self) -> list[_Record]: ...
    def warnings(self) -> list[str]: ...
    def value_warnings(self) -> list[str]: ...
    def copies_of(self, trained: Dataset) -> list[str]: ...

@final
class FitSpec:
    def __new__(cls, options: str, rate: str, data: Dataset) -> FitSpec: ...
    @staticmethod
    def variants(options: str, rate: str, data: Dataset) -> list[FitSpec]: ...
    @staticmethod
    def check(options: str) -> None: ...
    def label(self) -> str: ...
    def model(self) -> str: ...
    def warnings(self, data: Dataset) -> list[str]: ...

@final
class Model:
    @staticmethod
    def from_json(text: str) -> Model: ...
    def to_json(self) -> str: ...
    def save(self, path: str | os.PathLike[str], force: bool) -> None: ...
    def report(
        self, path: str | os.PathLike[str], title: str | None, sets: list[tuple[str, Dataset]], force: bool
    ) -> None: ...
    def export(
        self,
        to: str,
        folder: str | os.PathLike[str],
        name: str,
        precision: str,
        rate: str,
        fmi: int,
        band: tuple[float, int] | None,
        inverse: bool,
        limits: tuple[float, float] | None,
        slew: float | None,
        force: bool,
    ) -> tuple[list[str], str | None]: ...
    def parameters(self) -> int: ...
    def law_parameters(self) -> list[tuple[str, float, str, str]] | None: ...
    def needs_time(self) -> bool: ...
    def simulate(
        self,
        name: str,
        time: _Column | None,
        inputs: list[_Column],
        rate: _Column | None,
        initial_state: str | None,
        state: RecordState | None,
    ) -> _Column: ...
    def predict(
        self,
        name: str,
        time: _Column | None,
        inputs: list[_Column],
        rate: _Column | None,
        probability: float,
        of_ten: int,
        initial_state: str | None,
        state: RecordState | None,
    ) -> list[_Column]: ...
    def find_state(
        self,
        name: str,
        time: _Column | None,
        inputs: list[_Column],
        rate: _Column | None,
        known: _Column,
    ) -> RecordState: ...
    def selection(self) -> list[str] | None: ...
    def evaluate(
        self, data: Dataset, after_warm_up: bool, initial_state: str | None, known: str | None
    ) -> str: ...
    def warm_up(self) -> int: ...
    def notes(self) -> list[str]: ...
    def range_warnings(self, data: Dataset) -> list[str]: ...
    def residuals(self, data: Dataset, initial_state: str | None) -> tuple[str, str]: ...
    def parameter_intervals(self, data: Dataset) -> str | None: ...
    def diagnose(self) -> tuple[str, str]: ...
    def cycles(
        self,
        division: str | None,
        field: str | None,
        smoothing_factor: int | None,
        density: float | None,
        height: float | None,
    ) -> str: ...
    def stepper(self, state: RecordState | None) -> Stepper: ...
    def inverse(
        self,
        limits: tuple[float, float] | None,
        slew: float | None,
        preview: float,
        band: tuple[float, int] | None,
    ) -> Inverse: ...

@final
class Inverse:
    def step(
        self, y: float, time: float | None, others: list[float]
    ) -> tuple[float, float, str, bool, float | None, float | None, int]: ...
    def run(
        self, y: _Column, time: _Column | None, others: list[_Column]
    ) -> tuple[_Column, _Column, list[str], _Column, _Column | None, _Column | None]: ...
    def best_preview(self, y: _Column, time: _Column | None, others: list[_Column]) -> float: ...
    def reset(self) -> None: ...

@final
class Plan:
    def to_json(self) -> str: ...
    def report(self, path: str | os.PathLike[str], title: str | None, force: bool) -> None: ...

@final
class ProgressLine:
    def __new__(cls) -> ProgressLine: ...
    def text(
        self,
        elapsed: float,
        done: float,
        most: float | None,
        part: str,
        error: float | None,
        columns: int,
        bar: bool,
    ) -> str: ...

@final
class RecordState: ...

@final
class Stepper:
    def step(
        self, x: float | Sequence[float], time: float | None = None, rate: float | None = None
    ) -> float: ...
    def trial(
        self, x: float | Sequence[float], time: float | None = None, rate: float | None = None
    ) -> float: ...
    def trial_tangent(
        self, x: float | Sequence[float], time: float | None = None, rate: float | None = None
    ) -> tuple[float, float]: ...
    def correct(self, y: float) -> None: ...
    def adapt(self, y: float, rows: int = 1000) -> None: ...
    @property
    def tracking(self) -> Tracking: ...
    def commit(self) -> None: ...
    def revert(self) -> None: ...
    def reset(self, initial_state: str | None = None) -> None: ...

@final
class Tracking:
    @property
    def gain(self) -> float: ...
    @property
    def offset(self) -> float: ...
    @property
    def disturbance(self) -> float: ...
    @property
    def decay(self) -> float: ...
    @property
    def kalman_gain(self) -> float: ...
    @property
    def residual(self) -> float | None: ...
    @property
    def memory_fits(self) -> bool | None: ...

def cycles(
    data: Dataset,
    smallest_reversal: float | None,
    smoothing: bool,
    division: str | None,
    field: str | None,
    smoothing_factor: int | None,
    smoothing_growth: float,
    density: float | None,
    height: float | None,
) -> str: ...
def figure_label(figure: str, input: str, output: str, time: str | None) -> str: ...
def figure_names() -> list[str]: ...
def level_figure_names() -> list[str]: ...
def axis_label(column: str) -> str: ...
def name_and_unit(column: str) -> tuple[str, str | None]: ...
def errors_text(errors: str) -> str: ...
def folds(
    data: Dataset, most: int
) -> list[tuple[list[tuple[int, int, int]], list[tuple[int, int, int]]]]: ...
def plan(
    data: Dataset | None,
    kind: str | None,
    range: tuple[float, float] | None,
    length: int | None,
    step: float | None,
    max_rate: float | None,
    wave: str | None,
    seed: int,
) -> Plan: ...
def restoring_force(
    records: Sequence[Sequence[_Column | None]],
    mass: float,
    is_absolute: bool,
    window: int | None,
) -> tuple[
    list[tuple[_Column, _Column]],
    tuple[int, int] | None,
    tuple[int, int] | None,
    tuple[float, float, float],
]: ...
def diagnose(data: Dataset, smallest_reversal: float, smoothing: bool) -> tuple[str, str]: ...
def identify(
    data: Dataset,
    request: FitSpec,
    threads: int | None,
    time_limit: float | None,
    progress: Callable[..., object] | None,
) -> tuple[Model, int, bool]: ...
def compare(
    data: Dataset,
    requests: list[FitSpec],
    test: Dataset | None,
    threads: int | None,
    time_limit: float | None,
    progress: Callable[..., object] | None,
) -> tuple[list[tuple[str, Model | None, str | None, float | None, str | None]], bool]: ...
def write_models(path: str | os.PathLike[str], content: bytes, beginning: int, force: bool) -> None: ...
def validate(
    data: Dataset,
    request: FitSpec,
    folds: int,
    threads: int | None,
    time_limit: float | None,
    progress: Callable[..., object] | None,
) -> tuple[str, str, bool]: ...
def model_names() -> list[ModelName]: ...
def option_names() -> list[str]: ...
def specimens() -> list[tuple[str, str | None, str, str, str, str, str]]: ...
def specimen(name: str, test: bool, noise: float, seed: int) -> Dataset: ...
def relay(x: _Column, r: float, s: float) -> _Column: ...
def play(x: _Column, r: float) -> _Column: ...
def stop(x: _Column, r: float) -> _Column: ...
def deteriorating_stop(x: _Column, r: float, beta: float) -> _Column: ...
def relaxation(x: _Column, time: _Column, tau: float) -> _Column: ...
def law(description: str, x: _Column, time: _Column | None, rate: str | None) -> _Column: ...
def unit_factor(found: str, trained: str) -> float | None: ...
