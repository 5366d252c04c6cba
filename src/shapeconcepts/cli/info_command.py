"""`shapeconcepts info`: what is in a model, and names for its concepts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from shapeconcepts.cli.concept_summary import UNKNOWN, in_words, model_summary, print_concepts
from shapeconcepts.cli.learning_on import say_edits
from shapeconcepts.cli.model_input import read_model
from shapeconcepts.cli.options import Json, ModelFile
from shapeconcepts.cli.terminal import fail, say, tell, tell_json

if TYPE_CHECKING:
    from shapeconcepts.model import ShapeConceptModel


def info(
    model: ModelFile,
    name: Annotated[
        list[str] | None,
        typer.Option(
            "--name",
            metavar="NUMBER=NAME",
            show_default=False,
            help="Name a concept, in the model file, such as `--name 3=mugs`; `3=` takes the name away. "
            "May be given several times.",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Show what is in a model: its concepts, and the parameters that it was learned with.

    With --name, concepts get names, which every command then uses instead of their numbers.
    """
    learned = read_model(model)
    if name:
        from shapeconcepts.model_file import ModelError

        _rename(learned, name)
        try:
            learned.save(model)
        except ModelError as error:
            fail(str(error))
        except OSError as error:
            fail(f"cannot write {model}: {error.strerror or error}")
    summary = model_summary(learned)
    if as_json:
        tell_json({"model": str(model), **summary})
        return
    tell(f"{model}: {in_words(learned)}; {summary['n_motifs']} {learned.ensemble_.columns}")
    tell(", ".join(f"{key} {value}" for key, value in summary["parameters"].items()))
    print_concepts(learned)
    say_edits(learned)
    if name:
        say(f"Wrote {model}")


def _rename(learned: ShapeConceptModel, assignments: list[str]) -> None:
    n_concepts = len(learned.concepts_)
    for assignment in assignments:
        number, is_one, title = (part.strip() for part in assignment.partition("="))
        if not is_one or not number.isascii() or not number.isdecimal() or int(number) >= n_concepts:
            raise typer.BadParameter(
                f"must be NUMBER=NAME with a number from 0 to {n_concepts - 1}, got {assignment!r}"
                if n_concepts
                else f"there is no concept to name, got {assignment!r}",
                param_hint="--name",
            )
        if title.isdecimal() or title == UNKNOWN or not (title.isprintable()):
            raise typer.BadParameter(
                f"a name must not be a number, {UNKNOWN!r} or hold control characters, got {title!r}",
                param_hint="--name",
            )
        learned.concepts_[int(number)].name = title
    titles = [concept.name for concept in learned.concepts_ if concept.name]
    for title in titles:
        if titles.count(title) > 1:
            raise typer.BadParameter(f"two concepts would be called {title!r}", param_hint="--name")
