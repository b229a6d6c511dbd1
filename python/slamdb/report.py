# SPDX-License-Identifier: BSD-3-Clause
"""Reports of verbs."""

import json
from typing import Any, Dict, Iterator, List, Type, TypeVar

R = TypeVar("R", bound="Report")


class Report:
    """What a verb did or found: the command's `--json` with attributes (schema/*.schema.json says which).

    `report.severities.error`, `report["severities"]["error"]`, `report.to_dict()`.
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

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self._values]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Report) and self._values == other._values

    def __repr__(self) -> str:
        return f"Report({json.dumps(self._values, indent=2)})"

    def to_dict(self) -> Dict[str, Any]:
        """The same as plain dictionaries and lists, equal to the command's `--json`."""
        copy: Dict[str, Any] = json.loads(json.dumps(self._values))
        return copy


class CheckReport(Report):
    """The report of a check: `report.inputs[0]` has the findings of the first input by rule."""

    @property
    def sound(self) -> bool:
        """Whether no input has an error."""
        return all(checked.get("sound", False) for checked in self["inputs"])

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
