# SPDX-License-Identifier: Apache-2.0
"""The one exception of this package's own."""
from __future__ import annotations


class Error(Exception):
    """What went wrong, where, and what to do about it.

    Wrong shapes and types of arguments are ValueError and TypeError, as everywhere in Python; Ctrl-C in long work is
    KeyboardInterrupt. All else that is expected to fail is this.

    Attributes
    ----------
    what : str
        One sentence, what is wrong.
    where : str
        The file, argument or value it is about; may be empty.
    todo : str
        What you can do; may be empty.
    id : str
        Names what a program may look for, as "contact-busy"; empty for what has no name.
    arguments : tuple of str
        What varies in the sentence of one with an id.
    """

    def __init__(self, what: str, where: str = "", todo: str = "", id: str = "", arguments: tuple[str, ...] = ()) -> None:
        super().__init__(what, where, todo, id, tuple(arguments))
        self.what, self.where, self.todo, self.id, self.arguments = what, where, todo, id, tuple(arguments)

    def __str__(self) -> str:
        """"where: what (todo)", as the command line tells it."""
        return (f"{self.where}: " if self.where else "") + self.what + (f" ({self.todo})" if self.todo else "")
