"""The form of a file: a field for each value, joints and links in pairs that fold, and any further key."""

from __future__ import annotations

import copy
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import suppress
from types import MappingProxyType
from typing import Any, TypeAlias, cast

from nicegui import ui

import linkwright as lw
from linkwright.browser.pages.edit.fields import meant, place_of, shown
from linkwright.browser.pages.frame import heading, picture, row, stack
from linkwright.browser.server.folder import Kind
from linkwright.browser.server.parts import Place, known_keys, meaning, parts_of, section_like, to_choose
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.catalogues.yaml_edit import YamlText
from linkwright.core.units.quantities import InputError
from linkwright.report.pictures.sections import section_picture

from .fields import Field, QuantityField, names_field, select_of, words_field

_VALUE = "Value (leave empty to remove)"
_LONG = 20
"""Letters of a value that need a wide field."""
_TYPES = ("revolute", "prismatic")
_BY_LINK = ("section", "material")
"""What a problem may choose for each link by itself."""
_PARTS: Mapping[str, str] = MappingProxyType(
    {"joint": "Joint", "link": "Link", "dh": "Frame (Denavit-Hartenberg)", "origin": "Frame"}
)


Edit: TypeAlias = Callable[[Callable[[YamlText], None], bool], Awaitable[bool]]
"""Changes the text, then makes the form anew where that is asked for; gives whether the text changed."""


class Form:
    """The fields of a text's content; what is changed in them goes to `edit`."""

    def __init__(self, kind: Kind, edit: Edit) -> None:
        self._kind: Kind = kind
        self._edit = edit
        self._fields: dict[Place, Field] = {}
        self._pairs: dict[int, _Pair] = {}
        self._open = {0}
        self._arm: Arm | None = None
        self._place = stack()

    def clear(self) -> None:
        """Show nothing."""
        self._place.clear()
        self._fields.clear()
        self._pairs.clear()

    def show(self, content: Mapping[str, Any], file: str) -> None:
        """Show a file's content; pairs that were open stay open."""
        self.clear()
        chain = content.get("chain")
        entries = cast("list[Any]", chain) if isinstance(chain, list) else []
        groups: dict[str, list[tuple[Place, Any]]] = {}
        for place, value in leaves({key: content[key] for key in content if not entries or key != "chain"}, ()):
            groups.setdefault(str(place[0]) if len(place) > 1 else "general", []).append((place, value))
        with self._place:
            self._group("General", groups.pop("general", []), content)
            for number, entry in enumerate(entries):
                self._pairs[number] = _Pair(self, number, entry, file, is_open=number in self._open)
            if entries:
                with row():
                    ui.button("Add a joint and link", on_click=self._add_pair).props("outline dense no-caps")
                    ui.button("Remove the last pair", on_click=self._drop_pair).props("outline dense no-caps")
            for name, held in groups.items():
                self._group(name.replace("_", " ").capitalize(), held, content)
            self.key_row("Any key", known_keys(self._kind, 0), "", file)

    def draw(self, arm: Arm | None) -> None:
        """Draw the sections of the arm that the text is of."""
        self._arm = arm
        for pair in self._pairs.values():
            pair.draw(arm)

    def mark(self, place: Place, message: str | None) -> None:
        """Say what is wrong at the field of a place, or of what it is in."""
        number = place[1] if place[:1] == ("chain",) and len(place) > 1 else None
        if message is not None and isinstance(number, int) and number in self._pairs:
            self._pairs[number].open()
        while place and place not in self._fields:
            place = place[:-1]
        for key, field in self._fields.items():
            field.error = message if key == place else None

    def folded(self, number: int, *, is_open: bool) -> None:
        """Remember which pairs are open."""
        (self._open.add if is_open else self._open.discard)(number)

    @property
    def arm(self) -> Arm | None:
        """The arm that was drawn last."""
        return self._arm

    def _group(self, title: str, held: list[tuple[Place, Any]], content: Mapping[str, Any]) -> None:
        if held:
            heading(title)
            with ui.element("div").classes("lw-fields"):
                for place, value in held:
                    below = place[1:] or place
                    label = " ".join(str(step + 1) if isinstance(step, int) else step for step in below)
                    self.field(place, value, label.replace("_", " "), content)
                    self._say_by_link(place, value, content)

    def _say_by_link(self, place: Place, value: Any, content: Mapping[str, Any]) -> None:
        """Beside a choice for all links what gives each link its own; beside that of the last link the way back."""
        if place[0] != "choose" or len(place) < 2 or place[1] not in _BY_LINK:
            return
        name = str(place[1])
        there = content["choose"][name]
        if isinstance(there, list):

            def turned() -> Any:
                links = () if self._arm is None else self._arm.links
                own = [str(number) for number, link in enumerate(links, start=1) if link.section is not None]
                return {number: copy.deepcopy(value) for number in own or ("1", "others")}

            words = f"{name} by link"
        elif list(there)[-1] == place[-1]:

            def turned() -> Any:
                lists = [cast("list[Any]", item) if isinstance(item, list) else [item] for item in there.values()]
                return list(dict.fromkeys(str(item) for each in lists for item in each))

            words = f"one {name} list for all links"
        else:
            return

        async def turn() -> None:
            await self._edit(lambda text: text.set(place[:2], turned()), True)

        ui.button(words.capitalize(), on_click=turn).props("flat dense no-caps align=left")

    def field(self, place: Place, value: Any, label: str, beside: Any) -> None:
        """The field of a value at a place; `beside` is what it stands in."""
        names = list(_TYPES) if place[0] == "chain" and place[-1] == "type" else to_choose(place)
        listed: list[Any] = value if isinstance(value, list) else [value]
        for step in place[:-1] if place[0] != "chain" else ():
            beside = beside[step]
        shape = str(beside.get("shape", "")) if isinstance(beside, dict) else ""
        title = meaning(self._kind, place, shape)

        async def change_to(now: Any) -> None:
            changed = meant(now, value) if isinstance(now, str) else now
            await self._edit(lambda text: text.set(place, changed), False)

        if names and all(item in names for item in listed):
            self._fields[place] = names_field(label, value, names, change_to, title)
        elif (parts := parts_of(value)) is not None:
            self._fields[place] = QuantityField(label, parts, title, change_to)
        else:
            made = words_field(label, words := shown(value), change_to, title)
            self._fields[place] = made
            if len(words) > _LONG:
                made.classes("lw-wide")

    def section_field(self, place: Place, value: Any) -> None:
        """The shape or stock size of a link, and the shape's dimensions."""
        chosen = str(value.get("shape", "")) if isinstance(value, dict) else str(value)

        async def change_to(now: Any) -> None:
            if now and now != chosen:
                await self._edit(lambda text: text.set(place, section_like(str(now), value)), True)

        names = [*lw.shapes, *to_choose(place)]
        if chosen not in names:
            self.field(place, value, "section", {})
            return
        self._fields[place] = names_field("section", chosen, names, change_to, meaning(self._kind, place))
        if isinstance(value, dict):
            for name, size in cast("dict[str, Any]", value).items():
                if name != "shape":
                    self.field((*place, name), size, name.replace("_", " "), value)

    def key_row(self, label: str, keys: list[str], prefix: str, file: str) -> None:
        """A key that is chosen by a part of it, what it means, and its value."""
        with row():
            key = ui.select(keys, label=label, with_input=True, new_value_mode="add-unique")
            key.props("dense outlined options-dense use-input hide-selected fill-input").classes("grow min-w-40")
            beside = ui.element("div").classes("grow min-w-40")
            set_it = ui.button("Set").props("outline dense no-caps")
        note = ui.label().classes("lw-note")
        value: list[ui.input | ui.select] = []

        def place_now() -> Place:
            with suppress(InputError):
                return place_of(prefix + str(key.value or ""), file) if key.value else ()
            return ()

        def chosen() -> None:
            beside.clear()
            place = place_now()
            note.text = meaning(self._kind, place) if place else ""
            note.visible = bool(note.text)
            names = to_choose(place) if place else []
            with beside:
                listed: Any = [] if names and place[:1] == ("choose",) else ""
                field = select_of(_VALUE, listed, names) if names else ui.input(_VALUE).props("dense outlined")
                value[:] = [field.classes("w-full")]

        async def set_key() -> None:
            said: Any = value[0].value or ""

            def change(text: YamlText) -> None:
                place = place_of(prefix + str(key.value or ""), file)
                if str(said).strip() not in ("", "[]"):
                    text.set(place, meant(said, text.get(place)))
                else:
                    text.remove(place)

            await self._edit(change, True)

        chosen()
        key.on_value_change(chosen)
        set_it.on_click(set_key)

    async def _add_pair(self) -> None:
        def add(text: YamlText) -> None:
            chain = text.get(["chain"])
            self._open.add(len(chain))
            text.append(["chain"], copy.deepcopy(chain[-1]))

        await self._edit(add, True)

    async def _drop_pair(self) -> None:
        def drop(text: YamlText) -> None:
            last = len(text.get(["chain"])) - 1
            if last < 1:
                raise InputError("", "chain", "needs one joint and link at least")
            text.remove(["chain", last])

        await self._edit(drop, True)


class _Pair:
    """A joint and the link that it carries, folded to a line; its fields are made once it is opened."""

    def __init__(self, form: Form, number: int, entry: Any, file: str, *, is_open: bool) -> None:
        self._form, self._number, self._file = form, number, file
        self._entry = _mapping(entry)
        self._made = False
        self._picture: ui.html | None = None
        self._fold = ui.expansion(_title(number, self._entry), value=is_open, on_value_change=self._turned)
        self._fold.classes("lw-pair")
        if is_open:
            self._make()

    def open(self) -> None:
        """Unfold it."""
        self._fold.value = True

    def draw(self, arm: Arm | None) -> None:
        """Draw the link's section."""
        if self._picture is not None:
            there = arm is not None and self._number < len(arm.links)
            self._picture.content = section_picture(arm, self._number) if arm is not None and there else ""

    def _turned(self) -> None:
        self._form.folded(self._number, is_open=bool(self._fold.value))
        if self._fold.value and not self._made:
            self._make()

    def _make(self) -> None:
        self._made = True
        number = self._number
        with self._fold:
            for part, held in self._entry.items():
                place: Place = ("chain", number, part)
                heading(_PARTS.get(part, part.replace("_", " ").capitalize()), 3)
                with ui.element("div").classes("lw-beside" if part == "link" else "w-full"):
                    with ui.element("div").classes("lw-fields"):
                        self._fields(place, held)
                    if part == "link":
                        self._picture = picture(save=False).classes("lw-section")
            keys = [key.partition(".")[2] for key in known_keys("arm", 1) if key.startswith("chain[1].")]
            self._form.key_row(f"Add to joint or link {number + 1}", keys, f"chain[{number + 1}].", self._file)
        self.draw(self._form.arm)

    def _fields(self, place: Place, held: Any) -> None:
        if not isinstance(held, dict):
            self._form.field(place, held, str(place[-1]), {})
            return
        for key, value in cast("dict[str, Any]", held).items():
            if key == "section":
                self._form.section_field((*place, key), value)
                continue
            for below, leaf in leaves(value, (*place, key)):
                label = " ".join(str(step + 1) if isinstance(step, int) else step for step in below[len(place) :])
                self._form.field(below, leaf, label.replace("_", " "), {})


def leaves(content: Any, place: Place) -> Iterator[tuple[Place, Any]]:
    """What a field can show: words, numbers, lists of them."""
    if isinstance(content, dict):
        for key, value in cast("dict[str, Any]", content).items():
            yield from leaves(value, (*place, str(key)))
    elif isinstance(content, list) and any(isinstance(item, dict) for item in cast("list[Any]", content)):
        for number, value in enumerate(cast("list[Any]", content)):
            yield from leaves(value, (*place, number))
    elif place:
        yield place, content


def _title(number: int, entry: Mapping[str, Any]) -> str:
    """A pair in a line: its joint, and its link's length, section and material."""
    joint, link = (_mapping(entry.get(name)) for name in ("joint", "link"))
    shape = _mapping(link.get("section")).get("shape", link.get("section"))
    long = f"link {link['length']}" if "length" in link else "rigid link" if link.get("rigid") else "link"
    entries = [f"{joint.get('type', 'revolute')} joint", long, str(shape or "").replace("_", " "), link.get("material")]
    return f"{number + 1}  {', '.join(str(item) for item in entries if item)}"


def _mapping(value: object) -> dict[str, Any]:
    return cast("dict[str, Any]", value) if isinstance(value, dict) else {}
