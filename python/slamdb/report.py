# SPDX-License-Identifier: BSD-3-Clause
"""Reports of verbs."""

import json
from typing import Any, Dict, Iterator, List, Mapping, Type, TypeVar

R = TypeVar("R", bound="Report")

_FEW, _SHORT = 8, 60  # members of a dictionary, and characters of a value, in the repr


class Report(Mapping[str, Any]):
    """What a verb did or found: the command's `--json` with attributes (schema/*.schema.json says which).

    `report.severities.error`, `report["severities"]["error"]`, `report.to_dict()`; a mapping, so that `len(report)`,
    `report.items()`, `dict(report)` and `pandas.Series(report)` do what they do of a dictionary. `print` shows its
    upper level.
    """

    def __init__(self, values: Dict[str, Any]) -> None:
        self._values = values

    @classmethod
    def parse(cls: Type[R], text: str) -> R:
        return cls(json.loads(text))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return _shown(self._values[name])
        except KeyError:
            raise AttributeError(f"the report has no {name!r}: it has {', '.join(self._values)}") from None

    def __getitem__(self, name: str) -> Any:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self._values]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Report) and self._values == other._values

    def __repr__(self) -> str:
        return f"<slamdb.{type(self).__name__}: {_brief(self._values)}>"

    def _repr_html_(self) -> str:
        from .notebook import html_of_report

        return html_of_report(self)

    def to_dict(self) -> Dict[str, Any]:
        """A copy as plain dictionaries and lists, equal to the command's `--json`."""
        copy: Dict[str, Any] = json.loads(json.dumps(self._values))
        return copy


class CheckReport(Report):
    """The report of a check: `report.inputs[0]` has the findings of the first input by rule."""

    @property
    def sound(self) -> bool:
        """Whether no input has an error."""
        return all(checked.get("sound", False) for checked in self["inputs"])

    @property
    def findings(self) -> List[Report]:
        """Those that were kept, of all inputs and rules; `finding.count` is of all of its rule."""
        found = []
        for checked in self["inputs"]:
            for result in checked.get("results", ()):
                of = {"input": checked["input"], **{key: result[key] for key in ("rule", "severity", "count")}}
                found += [Report({**of, **finding}) for finding in result["findings"]]
        return found

    def _repr_html_(self) -> str:
        from .notebook import html_of_check

        return html_of_check(self)

    def to_pandas(self) -> Any:
        """A DataFrame with a row for each finding that is kept (`count`: all of its rule), ids of its place, <NA> where
        they do not apply, and one of the rule "unreadable" for each input that could not be read.

        Raises ImportError where pandas is not installed.
        """
        from .tables import frame_of_findings

        return frame_of_findings(self)


def _shown(value: Any) -> Any:
    if isinstance(value, dict):
        return Report(value)
    if isinstance(value, list):
        return [_shown(item) for item in value]
    return value


def _brief(values: Dict[str, Any]) -> str:
    """Scalars as they are; of lists and of what lies deeper only how much there is."""
    return ", ".join(f"{name}={_brief_value(value)}" for name, value in values.items())


def _brief_value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{len(value)}]"
    if isinstance(value, dict):
        flat = all(not isinstance(inner, (dict, list)) for inner in value.values()) and len(value) <= _FEW
        return "{" + (_brief(value) if flat else f"{len(value)}") + "}"
    text = repr(value)
    return text if len(text) <= _SHORT else text[: _SHORT - 3] + "..."
