"""The part of a diagnosis's report on the design with the corrected physics."""

from __future__ import annotations

from linkwright.redesign import Redesign
from linkwright.redesign_words import redesign_sentences
from linkwright.words import mm

from . import parts
from .section_picture import sections_grid
from .svg import element, text


def redesign_part(redesign: Redesign) -> str:
    """What changes: sentences, figures, sections and links of both optima."""
    tiles = (
        ("promised", mm(redesign.promised), "the old optimum, in the model as given"),
        ("really had", mm(redesign.had), "the old optimum, with what was found"),
        ("new optimum", mm(redesign.has), "with what was found"),
    )
    arms = (("before", redesign.old.arm), ("after", redesign.new.arm))
    lines = element("ul", *(element("li", text(each)) for each in redesign_sentences(redesign)), class_="binding")
    named = (("before", redesign.old.after), ("after", redesign.new.after))
    words = "Before is the optimum of the arm as given, after that of the corrected arm."
    below = element("p", text(words), class_="lead")
    return parts.tiles(tiles) + lines + below + sections_grid(arms) + parts.links(named)
