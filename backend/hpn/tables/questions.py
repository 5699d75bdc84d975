"""Open questions about a table, and the choices of how it is read."""

from dataclasses import replace
from typing import Any

from hpn.tables.columns import Choices
from hpn.tables.table import Choice
from hpn.words.wording import Sentence, Value


class Questions:
    """Open questions about a table, and the choices of how it is read, given the answers so far."""

    def __init__(self, answers: Choices) -> None:
        self.answers = answers
        self.open: list[Sentence] = []
        self.choices: list[Choice] = []

    def ask(self, template: str, **values: Value) -> None:
        """Add a question."""
        self.open.append(Sentence(template, dict(values)))

    def choose(self, choice: Choice, question: Sentence, **more: Any) -> str:
        """The answered option, else `chosen`, the usual one; without either, blank, and the question is asked."""
        answer: str = getattr(self.answers, choice.name)
        if answer in choice.options:
            more["chosen"] = answer
        current = replace(choice, question=question, **more)
        self.choices.append(current)
        if not current.chosen:
            self.open.append(question)
        return current.chosen
