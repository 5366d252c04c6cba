"""What a user says of a model's concepts: edits, their journal, and what to ask next."""

from shapeconcepts.corrections.corrections import Corrections
from shapeconcepts.corrections.doubt import Likeness
from shapeconcepts.corrections.edit import Edit, Link
from shapeconcepts.corrections.journal import Journal
from shapeconcepts.corrections.journal_file import JournalFile
from shapeconcepts.corrections.question import Question

__all__ = ["Corrections", "Edit", "Journal", "JournalFile", "Likeness", "Link", "Question"]
