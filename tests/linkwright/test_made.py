"""Commands are made of the functions of `linkwright`: their options are its parameters, their help its docstring."""

import inspect

import pytest
import typer

import linkwright as lw
from linkwright.api.signature import Argument
from linkwright.command_line import command_line, commands
from linkwright.commands.from_face import commands as of_functions
from linkwright.commands.made import Targets, help_of

SHARED = {*Targets.__dataclass_fields__, "tip", "catalogue", "workers", "dask", "quiet", "verbose"}
"""What commands ask for beside what their functions do: files to read and write, who works, how much is shown."""
FOR_PROGRAMS = {"progress", "workers", "executor", "log", "out_of_reach", "begun", "frame", "tool"}
"""What functions take and no command asks for: who hears of the work and who does it, and a frame known otherwise."""


MADE = of_functions()


def test_commands_are_made():
    """Nearly all: a server, a look at the installation and the catalogues' editors are no functions of one call."""
    assert {"evaluate", "optimize", "tradeoff", "diagnose", "plan", "simulate", "import", "export", "seam"} <= set(MADE)
    assert set(commands()) - set(MADE) == {"serve", "doctor", "materials", "sections", "actuators", "effects"}


@pytest.mark.parametrize("name", sorted(MADE))
def test_options_are_the_parameters_of_the_function(name):
    """Each of them, and nothing else but what all commands share; the help is that of the docstring."""
    own = MADE[name]
    function = getattr(lw, own.called)
    command = typer.main.get_command(command_line(name)).commands[name]
    takes, asks = set(inspect.signature(function).parameters), {param.name for param in command.params} - {"help"}
    assert takes - asks - FOR_PROGRAMS == set()
    assert asks - takes - SHARED == set()
    assert " ".join((command.help or "").split()) == " ".join(help_of(function).split())
    assert "Example: linkwright " in (command.help or "")


@pytest.mark.parametrize("name", sorted(MADE))
def test_each_parameter_is_told_of(name):
    """Under `Args`, without what concerns programs alone; its default is that of the function."""
    own = MADE[name]
    signature = inspect.signature(getattr(lw, own.called)).parameters
    for parameter in own.parameters:
        assert parameter.help, parameter.name
        assert "In Python" not in parameter.help
        assert parameter.default is signature[parameter.name].default
        typed = parameter.typed()
        if not isinstance(parameter.option, Argument) and not parameter.option.required:
            shown = (
                typed.default
                if parameter.kind is not bool
                else not typed.default
                if parameter.default
                else typed.default
            )
            assert shown == (None if parameter.default in ((), None) else parameter.default)


def test_errors_of_a_function_speak_of_options(linkwright, bench):
    """The parameter at fault, and another that its message names."""
    (bench / "poses.csv").write_text("q1_deg,q2_deg\n10,20\n", encoding="utf-8")
    status, out, err = linkwright("compensate", "arm.yaml", "--poses", "poses.csv", "--grid", "3")
    assert (status, out) == (2, "")
    assert err.startswith("--poses: goes without --grid")
    with pytest.raises(lw.InputError, match="poses: goes without `grid`"):
        lw.compensate("arm.yaml", poses="poses.csv", grid=3)
    status, _, err = linkwright("plan", "arm.yaml", "--poses", "10", "--for", "backlsh")
    assert (status, err.partition(":")[0]) == (2, "--for")
