"""Design robot arms for the least worst-case position error, and diagnose what a model of a real arm lacks.

`import linkwright as lw` and ask: `lw.evaluate`, `lw.optimize`, `lw.diagnose`, ... Every name is loaded when it is
first used, so the import alone costs nothing. Quantities are text with a unit (`"400 mm"`) or numbers in SI.

What adds to it needs these names (docs/how-to/extending.md): `lw.Effect`, `lw.Figure`, `lw.Shape`, `lw.numeric`, ...;
an instrument those of `linkwright.core.diagnose.instruments` too, a shape with walls `linkwright.core.sections.Wall`.
The rest of the engine, `linkwright.core`, may change from one version to the next.
"""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from linkwright.api.design import budget, evaluate, inverse, optimize, tradeoff
    from linkwright.api.diagnosis import compare, compensate, diagnose, predict, redesign, watch
    from linkwright.api.exchange import export_arm, import_arm
    from linkwright.api.paper import paper_figures, paper_tables, seam
    from linkwright.api.recording import columns, plan, simulate
    from linkwright.core.arm.chain.statics import PoseState
    from linkwright.core.arm.effects import Effect, Parameter, Settings, Twist, traits
    from linkwright.core.arm.effects.effect import drive_motion
    from linkwright.core.arm.figures import Figure, OfDesign, OfKinds, OfLinks, at_poses
    from linkwright.core.executors import Cluster, Processes
    from linkwright.core.materials.material import MissingProperty
    from linkwright.core.sections import numeric
    from linkwright.core.sections.section import Dimension
    from linkwright.core.units.quantities import InputError, NoAnswer
    from linkwright.face.arm import Arm, Joint, Link, read_arm
    from linkwright.face.catalogues.catalogues import actuators, materials, sections
    from linkwright.face.catalogues.effects import effects
    from linkwright.face.catalogues.instruments import instruments
    from linkwright.face.catalogues.limits import limits
    from linkwright.face.catalogues.shapes import Shape, shapes
    from linkwright.face.motion.log import read_log
    from linkwright.face.planning.sweep import sweep
    from linkwright.face.problem import Problem, read_problem
    from linkwright.face.recording import read_recording, read_recordings
    from linkwright.face.space.view import show
    from linkwright.output.table_file import write_table

HOMES = MappingProxyType(
    {
        "linkwright.api.design": ("budget", "evaluate", "inverse", "optimize", "tradeoff"),
        "linkwright.api.diagnosis": ("compare", "compensate", "diagnose", "predict", "redesign", "watch"),
        "linkwright.api.exchange": ("export_arm", "import_arm"),
        "linkwright.api.paper": ("paper_figures", "paper_tables", "seam"),
        "linkwright.api.recording": ("columns", "plan", "simulate"),
        "linkwright.core.arm.chain.statics": ("PoseState",),
        "linkwright.core.arm.effects": ("Effect", "Parameter", "Settings", "Twist", "traits"),
        "linkwright.core.arm.effects.effect": ("drive_motion",),
        "linkwright.core.executors": ("Cluster", "Processes"),
        "linkwright.core.materials.material": ("MissingProperty",),
        "linkwright.core.arm.figures": ("Figure", "OfDesign", "OfKinds", "OfLinks", "at_poses"),
        "linkwright.core.sections": ("numeric",),
        "linkwright.core.sections.section": ("Dimension",),
        "linkwright.core.units.quantities": ("InputError", "NoAnswer"),
        "linkwright.face.arm": ("Arm", "Joint", "Link", "read_arm"),
        "linkwright.face.catalogues.effects": ("effects",),
        "linkwright.face.catalogues.instruments": ("instruments",),
        "linkwright.face.catalogues.limits": ("limits",),
        "linkwright.face.catalogues.catalogues": ("actuators", "materials", "sections"),
        "linkwright.face.catalogues.shapes": ("Shape", "shapes"),
        "linkwright.face.motion.log": ("read_log",),
        "linkwright.face.planning.sweep": ("sweep",),
        "linkwright.face.problem": ("Problem", "read_problem"),
        "linkwright.face.recording": ("read_recording", "read_recordings"),
        "linkwright.face.space.view": ("show",),
        "linkwright.output.table_file": ("write_table",),
    }
)
"""Where each public name stands."""

__all__ = [
    "Arm",
    "Cluster",
    "Dimension",
    "Effect",
    "Figure",
    "InputError",
    "Joint",
    "Link",
    "MissingProperty",
    "NoAnswer",
    "OfDesign",
    "OfKinds",
    "OfLinks",
    "Parameter",
    "PoseState",
    "Problem",
    "Processes",
    "Settings",
    "Shape",
    "Twist",
    "actuators",
    "at_poses",
    "budget",
    "columns",
    "compare",
    "compensate",
    "diagnose",
    "drive_motion",
    "effects",
    "evaluate",
    "export_arm",
    "import_arm",
    "instruments",
    "inverse",
    "limits",
    "materials",
    "numeric",
    "optimize",
    "paper_figures",
    "paper_tables",
    "plan",
    "predict",
    "read_arm",
    "read_log",
    "read_problem",
    "read_recording",
    "read_recordings",
    "redesign",
    "seam",
    "sections",
    "shapes",
    "show",
    "simulate",
    "sweep",
    "tradeoff",
    "traits",
    "watch",
    "write_table",
]


def __getattr__(name: str) -> Any:
    """A public name, loaded from where it stands and kept."""
    if name == "__version__":
        from linkwright.version import program_version

        return program_version()
    home = next((module for module, names in HOMES.items() if name in names), None)
    if home is None:
        raise AttributeError(f"module 'linkwright' has no attribute '{name}'")
    value = getattr(import_module(home), name)
    if home.startswith("linkwright.api."):
        from linkwright.api.signature import shown_signature

        value.__signature__ = shown_signature(value)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names."""
    return sorted([*__all__, "__version__"])
