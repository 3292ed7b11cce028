"""The rules of the house, read from the source: who may use whom, and what no file may hold."""

import ast
import re
import subprocess
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest
from radon.complexity import cc_rank, cc_visit_ast
from radon.visitors import Function

from linkwright.core.arm.effects import EFFECTS

ROOT = Path(__file__).resolve().parent.parent

# What each room may use beside itself. Nobody walks back up, and optimize and diagnose stay strangers.
MAY_USE = {
    "units": set(),
    "registries": {"units"},
    "executors": {"units"},
    "sections": {"units", "registries"},
    "materials": {"units"},
    "catalogues": {"units", "sections", "materials"},
    "arm": {"units", "registries", "sections", "materials"},
    "optimize": {"units", "registries", "executors", "arm", "sections", "materials"},
    "diagnose": {"units", "registries", "executors", "arm", "sections", "materials"},
    "linkwright": {
        "units",
        "registries",
        "executors",
        "sections",
        "materials",
        "catalogues",
        "arm",
        "optimize",
        "diagnose",
    },
}


def tracked_files() -> list[Path]:
    """The files of the project: those git tracks or would; without git, all that stand there."""
    listing = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        capture_output=True,
        text=True,
        check=False,
    )
    if listing.returncode == 0:
        return sorted(path for name in set(listing.stdout.split("\0")) if name and (path := ROOT / name).is_file())
    aside = re.compile(r"\.|(build|dist|__pycache__)$|demo-out|.*\.egg-info$")  # what .gitignore leaves out
    return sorted(
        path
        for path in ROOT.rglob("*")
        if path.is_file() and not any(aside.match(part) for part in path.relative_to(ROOT).parts[:-1])
    )


CORE = ROOT / "linkwright" / "core"
"""Where the rooms at the top are linked to, and so what they are imported as."""


def module_name(path: Path) -> str:
    parts = list(path.relative_to(ROOT).with_suffix("").parts)
    if (CORE / parts[0]).is_symlink():
        parts = ["linkwright", "core", *parts]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def room_of(name: str) -> str:
    """The room of a module: `arm` for `linkwright.core.arm.chain`, `linkwright` for what people meet."""
    inside = name.removeprefix("linkwright.core.")
    return inside.split(".")[0]


MODULES = {
    module_name(path): path
    for path in tracked_files()
    if path.suffix == ".py" and path.relative_to(ROOT).parts[0] in MAY_USE
}


@cache
def syntax(source: str) -> ast.Module:
    """Most checks read the same files, and reading is what takes time."""
    return ast.parse(source)


def imported(name: str, source: str, is_package: bool, modules: set[str], *, at_load: bool) -> set[str]:
    """Those of `modules` that the module imports; with `at_load`, only while it is loaded itself."""
    results: set[str] = set()
    for node in _import_statements(syntax(source), at_load=at_load):
        if isinstance(node, ast.Import):
            candidates = [alias.name for alias in node.names]
        else:
            base = node.module or ""
            if node.level:
                package = name.split(".") if is_package else name.split(".")[:-1]
                package = package[: len(package) - node.level + 1]
                base = ".".join([*package, base]) if base else ".".join(package)
            candidates = [base, *(f"{base}.{alias.name}" for alias in node.names)]
            # `from package import module` needs the module; the package only where a name comes from it.
            if all(candidate in modules for candidate in candidates[1:]):
                candidates = candidates[1:]
        for candidate in candidates:
            while candidate and candidate not in modules:
                candidate = candidate.rpartition(".")[0]
            if candidate:
                results.add(candidate)
    return results - {name}


def _import_statements(tree: ast.AST, *, at_load: bool) -> Iterator[ast.Import | ast.ImportFrom]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif at_load and isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            continue
        elif at_load and isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING"):
            for other in node.orelse:
                yield from _import_statements(ast.Module([other], []), at_load=at_load)
        else:
            yield from _import_statements(node, at_load=at_load)


def asked(path: Path) -> tuple[str, str, bool]:
    """A module's name, its source, and whether it is a package."""
    return module_name(path), path.read_text(encoding="utf-8"), path.name == "__init__.py"


def imports_of(name: str, *, at_load: bool) -> set[str]:
    return imported(*asked(MODULES[name]), set(MODULES), at_load=at_load)


def upward_uses(graph: dict[str, set[str]]) -> list[str]:
    """Imports that a room is not allowed, as sentences."""
    return [
        f"{name} uses {other}"
        for name, others in sorted(graph.items())
        for other in sorted(others)
        if (room := room_of(name)) != (used := room_of(other)) and used not in MAY_USE[room]
    ]


def a_cycle(graph: dict[str, set[str]]) -> list[str] | None:
    """One cycle of the graph, its first module repeated at the end, or None."""
    done: set[str] = set()
    for start in sorted(graph):
        trail: list[str] = []
        pending = [(start, iter(sorted(graph[start])))]
        trail.append(start)
        while pending:
            name, rest = pending[-1]
            following = next((other for other in rest if other not in done), None)
            if following is None:
                done.add(name)
                pending.pop()
                trail.pop()
            elif following in trail:
                return [*trail[trail.index(following) :], following]
            else:
                trail.append(following)
                pending.append((following, iter(sorted(graph[following]))))
    return None


MUTABLE_MAKERS = {"list", "dict", "set", "defaultdict", "OrderedDict", "Counter", "deque", "bytearray"}
MUTABLE_DISPLAYS = (ast.List, ast.Dict, ast.Set, ast.ListComp, ast.DictComp, ast.SetComp)


def mutable_state(source: str) -> list[str]:
    """Module-level names bound to something that can be changed, and functions that rebind such names.

    A literal behind MappingProxyType, tuple or frozenset is a constant. A list that is meant to grow is
    a `registries.Registry`, which owns its entries and says what may be added. `__all__` is what the language asks for.
    """
    tree = syntax(source)
    results = []
    for node in tree.body:
        if isinstance(node, ast.Assign):
            targets, value = node.targets, node.value
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets, value = [node.target], node.value
        else:
            continue
        names = ", ".join(ast.unparse(target) for target in targets)
        makes = isinstance(value, ast.Call) and ast.unparse(value.func).rpartition(".")[2] in MUTABLE_MAKERS
        if names != "__all__" and (isinstance(value, MUTABLE_DISPLAYS) or makes):
            results.append(f"line {node.lineno}: {names} can be changed")
    results += [
        f"line {node.lineno}: global {', '.join(node.names)}" for node in ast.walk(tree) if isinstance(node, ast.Global)
    ]
    return results


def swallowed_errors(source: str) -> list[int]:
    """Lines of handlers that take any error: bare, Exception or BaseException, alone or among others."""
    lines = []
    for node in ast.walk(syntax(source)) if "except" in source else ():
        if isinstance(node, ast.ExceptHandler):
            kinds = node.type.elts if isinstance(node.type, ast.Tuple) else [node.type]
            names = ["" if kind is None else ast.unparse(kind) for kind in kinds]
            if any(name.rpartition(".")[2] in ("", "Exception", "BaseException") for name in names):
                lines.append(node.lineno)
    return lines


# Words that name other things too: keys of joints and arms, ranges of a problem, a material's figure.
OTHER_MEANINGS = {
    "armature",
    "backlash",
    "clearance",
    "link_length",
    "payload",
    "spring",
    "thermal_expansion",
    "torque_constant",
}
SPEAKS_OF_EFFECTS = re.compile(r"effect|candidate|leave_out|signature", re.IGNORECASE)


def named_effects(source: str, ids: set[str]) -> list[str]:
    """Effects that code names by their ids: whatever it knows of them should stand on the `Effect`.

    A word with other meanings counts where the line's expression speaks of effects.
    """
    tree = syntax(source)
    results = []
    for node in ast.walk(tree):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Constant) and isinstance(child.value, str) and child.value in ids:
                about = ast.unparse(node).replace(f"'{child.value}'", "")
                if child.value not in OTHER_MEANINGS or SPEAKS_OF_EFFECTS.search(about):
                    results.append(f"line {child.lineno}: {child.value}")
    return results


# The paper's own model leaves effects out and adds others, as anybody's arm file does.
NAMES_EFFECTS = ROOT / "linkwright" / "paper"


# Written in pieces, so that this file does not hold what it looks for.
MACHINE_NAMES = re.compile(
    "|".join(
        [
            r"(?<![\w.:/])/(?:" + "|".join(["home", "Users", "root", "work", "mnt", "private"]) + r")/\w",
            r"\b[A-Za-z]:\\" + r"Users\\",
            r"files\." + r"pythonhosted\.org",
            r"\bpypi\." + r"org/simple",
            r"--(?:extra-)?" + r"index-url[ =]",
            r"--trusted" + r"-host[ =]",
            r"--find" + r"-links[ =]",
            r"\bregistry\." + r"npmjs\.org",
        ]
    )
)
NOT_TEXT = {
    ".png",
    ".jpg",
    ".jpeg",
    ".gif",
    ".ico",
    ".pdf",
    ".zip",
    ".gz",
    ".whl",
    ".parquet",
    ".npz",
    ".woff",
    ".woff2",
}


def machine_names(text: str) -> list[str]:
    """Absolute paths of one machine and hosts of package registries, each with its line number."""
    return [f"line {text.count(chr(10), 0, hit.start()) + 1}: {hit.group()}" for hit in MACHINE_NAMES.finditer(text)]


def test_every_room_stands():
    """The checks below would pass on nothing."""
    assert {room_of(name) for name in MODULES} == set(MAY_USE)


def test_rooms_use_only_rooms_above_them():
    """Imports inside functions count as well."""
    assert upward_uses({name: imports_of(name, at_load=False) for name in MODULES}) == []


MOST_FILES = 15
"""Files that a folder may hold of its own: about a dozen. What is data beside code counts as well."""


def crowded(paths: list[Path]) -> dict[str, int]:
    """Folders below the root with more files than that, each with its number; `__init__.py` does not count."""
    counts = Counter(path.parent for path in paths if path.name != "__init__.py" and path.parent != ROOT)
    return {str(folder.relative_to(ROOT)): number for folder, number in counts.items() if number > MOST_FILES}


def test_no_folder_is_crowded():
    """Who opens a folder should see what it is for."""
    assert crowded(tracked_files()) == {}


def test_crowding_is_seen():
    """The check above checked: one file too many, the root and package markers left out."""
    full = [ROOT / "arm" / f"part_{number}.py" for number in range(MOST_FILES)]
    assert crowded([*full, ROOT / "arm" / "__init__.py", *(ROOT / path.name for path in full)]) == {}
    assert crowded([*full, ROOT / "arm" / "more.yaml"]) == {"arm": MOST_FILES + 1}


def test_no_cycle_between_modules():
    """Among imports that run while a module loads; type-only ones cannot form a cycle."""
    assert a_cycle({name: imports_of(name, at_load=True) for name in MODULES}) is None


def complex_functions(source: str) -> list[str]:
    """Functions of a cyclomatic complexity above 20: radon's grade D or worse."""
    functions = (block for block in cc_visit_ast(syntax(source)) if isinstance(block, Function))
    return [f"{each.name} ({each.complexity})" for each in functions if cc_rank(each.complexity) > "C"]


def test_no_function_is_complex():
    """Its steps have names."""
    results = {
        name: names for name, path in MODULES.items() if (names := complex_functions(path.read_text(encoding="utf-8")))
    }
    assert results == {}


def test_complexity_is_seen():
    """Of methods as well, from one branch too many on."""
    method = "class A:\n    def f(self, x):\n" + "        if x: pass\n" * 19
    assert complex_functions(method) == []
    assert complex_functions(method + "        if x: pass\n") == ["f (21)"]


MUTUAL = 8
"""Pairs of rooms of the diagnosis that use each other. Lower it."""


def mutual(graph: dict[str, set[str]], room: Callable[[str], str]) -> list[str]:
    """Pairs of rooms of which modules use each other's."""
    used = {(room(name), room(other)) for name, others in graph.items() for other in others}
    return sorted(f"{one} and {other}" for one, other in used if one < other and (other, one) in used)


def in_the_diagnosis(name: str) -> str:
    """The room within `diagnose/` that a module stands in; its top for what stands in none."""
    inside = MODULES[name].relative_to(ROOT / "diagnose").parts
    return inside[0] if len(inside) > 1 else "the top"


def test_few_rooms_of_the_diagnosis_use_each_other():
    """What is asked first does not ask what comes after it."""
    names = {name for name in MODULES if room_of(name) == "diagnose"}
    pairs = mutual({name: imports_of(name, at_load=False) & names for name in names}, in_the_diagnosis)
    assert len(pairs) <= MUTUAL, pairs


def test_mutual_use_is_seen():
    """Through any modules of two rooms, and once."""
    graph = {"a.x": {"b.x", "a.y"}, "a.y": {"c.x"}, "b.y": {"a.y"}, "c.x": {"b.x"}}
    assert mutual(graph, lambda name: name[0]) == ["a and b"]


def test_package_code_imports_nothing_of_tests_or_benchmarks():
    """They are not installed."""
    strangers = {"tests", "benchmarks"}
    results = {
        name: used
        for name, path in MODULES.items()
        if (used := imported(name, path.read_text(encoding="utf-8"), False, strangers, at_load=False))
    }
    assert results == {}


def test_no_module_keeps_state():
    """What a run learns belongs to its objects; a module-level container is shared by all."""
    results = {
        name: lines for name, path in MODULES.items() if (lines := mutable_state(path.read_text(encoding="utf-8")))
    }
    assert results == {}


def test_no_handler_takes_any_error():
    """Also in tests and benchmarks: an error that nobody expected must be seen."""
    results = {
        str(path.relative_to(ROOT)): lines
        for path in tracked_files()
        if path.suffix == ".py" and (lines := swallowed_errors(path.read_text(encoding="utf-8")))
    }
    assert results == {}


def test_no_code_names_an_effect():
    """But for the effect's own file; `aliases` there name others."""
    shipped = {effect.id for effect in EFFECTS.values()}
    results = {
        name: lines
        for name, path in MODULES.items()
        if path.stem not in shipped
        and not path.is_relative_to(NAMES_EFFECTS)
        and (lines := named_effects(path.read_text(encoding="utf-8"), shipped))
    }
    assert results == {}


def test_no_file_names_a_machine_or_a_registry():
    """A clone works anywhere; where packages come from is for whoever installs to say."""
    results = {
        str(path.relative_to(ROOT)): hits
        for path in tracked_files()
        if path.suffix not in NOT_TEXT and (hits := machine_names(path.read_text(encoding="utf-8")))
    }
    assert results == {}


# The checks checked: each must find what it is there to find.


@pytest.mark.parametrize(
    ("source", "used"),
    [
        ("import arm.chain", {"arm.chain"}),
        ("from arm import chain", {"arm.chain"}),
        ("from arm.chain import Chain", {"arm.chain"}),
        ("from arm import Chain", {"arm"}),
        ("def f():\n    from arm.chain import Chain", {"arm.chain"}),
        ("import armature", set()),
    ],
)
def test_imports_are_found(source, used):
    """Of modules and of names, at the top and inside functions."""
    assert imported("optimize.problem", source, False, {"arm", "arm.chain"}, at_load=False) == used


def test_relative_imports_are_resolved():
    """One dot is the module's own package, of an __init__ the package itself."""
    modules = {"arm", "arm.chain", "arm.effects", "arm.effects.bending"}
    for name, is_package, source, used in (
        ("arm.effects.bending", False, "from ..chain import Chain", {"arm.chain"}),
        ("arm.effects", True, "from .bending import BENDING", {"arm.effects.bending"}),
        ("arm.effects", True, "from ..chain import Chain", {"arm.chain"}),
        ("arm.chain", False, "from . import effects", {"arm.effects"}),
    ):
        assert imported(name, source, is_package, modules, at_load=False) == used


def test_type_only_and_late_imports_do_not_run_at_load():
    """They count for the rooms and not for the cycles."""
    source = "if TYPE_CHECKING:\n    import arm.chain\ndef f():\n    import arm.chain\n"
    assert imported("arm.loads", source, False, {"arm.chain"}, at_load=True) == set()
    assert imported("arm.loads", source, False, {"arm.chain"}, at_load=False) == {"arm.chain"}


def test_upward_uses_are_found():
    """Optimize and diagnose never see each other, and nobody uses the command line."""
    chain, exchange, search = (
        f"linkwright.core.{name}" for name in ("arm.chain", "optimize.exchange", "diagnose.search")
    )
    graph = {exchange: {search, chain}, chain: {"linkwright.face", "linkwright.core.sections"}}
    assert upward_uses(graph) == [f"{chain} uses linkwright.face", f"{exchange} uses {search}"]


def test_the_rooms_are_imported_by_one_name():
    """As `linkwright.core.arm`, never as `arm`: anybody's `arm.py` may stand beside a script."""
    rooms = set(MAY_USE) - {"linkwright"}
    assert {item.name for item in CORE.iterdir() if (item / "__init__.py").is_file()} == rooms
    statement = re.compile(rf"\b(?:import|from)\b(?:\\\n|.)*(?<![.\w])(?:{'|'.join(rooms)})\b")
    results = {
        str(path.relative_to(ROOT)): bare
        for path in tracked_files()
        if path.suffix == ".py"
        and statement.search(path.read_text(encoding="utf-8"))
        and (bare := imported(*asked(path), rooms, at_load=False))
    }
    assert results == {}


def test_cycles_are_found():
    """Also long ones, off the first path walked."""
    assert a_cycle({"a": {"b", "c"}, "b": set(), "c": {"d"}, "d": {"c"}}) == ["c", "d", "c"]
    assert a_cycle({"a": {"b", "c"}, "b": {"c"}, "c": set()}) is None


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("cache = {}", 1),
        ("SIZES: list[int] = [1, 2]", 1),
        ("seen = collections.defaultdict(list)", 1),
        ("def f():\n    global count\n    count = 1", 1),
        ("SIZES = (1, 2)\nNAMES = frozenset({'a'})\nMAP = MappingProxyType({'a': 1})\n__all__ = ['f']", 0),
        ("def f():\n    names = []", 0),
    ],
)
def test_mutable_state_is_found(source, count):
    """Literals, comprehensions, constructors and `global`; wrapped literals and local names are fine."""
    assert len(mutable_state(source)) == count


@pytest.mark.parametrize(
    ("handler", "lines"),
    [
        ("except:", [3]),
        ("except Exception:", [3]),
        ("except (ValueError, BaseException):", [3]),
        ("except OSError:", []),
    ],
)
def test_swallowed_errors_are_found(handler, lines):
    """In all their spellings."""
    assert swallowed_errors(f"try:\n    f()\n{handler}\n    pass\n") == lines


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("if effect.id == 'creep': pass", 1),
        ("LINKS = frozenset({'axial', 'torsion'})", 2),
        ("RANK = MappingProxyType({'creep': 3, 'backlash': 4})", 1),
        ("if candidate.effect == 'backlash': pass", 1),
        ("observed.signature('payload', settings)", 1),
        ("EFFECTS['clearance']", 1),
        ("clearance = keys.quantity('clearance', 'length')", 0),
        ("'creep is slow'", 0),
    ],
)
def test_named_effects_are_found(source, count):
    """Compared, listed, looked up; a key of the arm file that an effect shares is none."""
    assert len(named_effects(source, {"creep", "axial", "torsion", *OTHER_MEANINGS})) == count


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("see " + "/home" + "/ann/arm.yaml", 1),
        ("cd '" + "/work" + "/tree'", 1),
        ("--index" + "-url https://example.invalid/simple", 1),
        ("src/home/arm.yaml and https://example.com/work/arm and N/mm", 0),
    ],
)
def test_machine_names_are_found(text, count):
    """Relative paths and addresses of pages are fine."""
    assert len(machine_names(text)) == count
