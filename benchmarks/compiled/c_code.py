"""C source from a tape: blocks of rows, one array per quantity, loops that a compiler can vectorise.

Steps are sorted into stages.  A stage of arithmetic is one loop over the block with everything in
registers; functions of the C library (exp, atan2, ...) have a loop each between such stages, as a call
would keep a loop from being vectorised.  Sine and cosine are computed inline, without a branch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import MappingProxyType

from linkwright.core.arm.compiled.tape import Tape, UnsupportedOperation, literal

FAR_ANGLE = 1.0e5
"""Beyond this angle in rad the inline sine and cosine are not trusted: such blocks are reported instead."""

BLOCK = 256
LONGEST_STAGE = 600
MOST_INLINE_ANGLES = 16
"""With more angles than this, sine and cosine become one function that is called on whole blocks: a bit
slower to run, but compiling each of them anew in place would take some 40 ms apiece."""

ENTRY = "linkwright_rows"

FORMULAS = MappingProxyType({
    "add": "{0} + {1}", "sub": "{0} - {1}", "mul": "{0} * {1}", "div": "{0} / {1}", "neg": "-{0}",
    "sq": "{0} * {0}", "twice": "{0} + {0}", "inv": "1.0 / {0}", "sqrt": "sqrt({0})", "fabs": "fabs({0})",
    "floor": "floor({0})", "ceil": "ceil({0})", "lt": "({0} < {1}) ? 1.0 : 0.0",
    "le": "({0} <= {1}) ? 1.0 : 0.0", "eq": "({0} == {1}) ? 1.0 : 0.0", "ne": "({0} != {1}) ? 1.0 : 0.0",
    "not": "({0} == 0.0) ? 1.0 : 0.0", "and": "(({0} != 0.0) & ({1} != 0.0)) ? 1.0 : 0.0",
    "or": "(({0} != 0.0) | ({1} != 0.0)) ? 1.0 : 0.0", "if_else_zero": "({0} != 0.0) ? {1} : 0.0",
    "sign": "({0} < 0.0) ? -1.0 : (({0} > 0.0) ? 1.0 : {0})", "copysign": "copysign({0}, {1})",
    "fmin": "(({0} <= {1}) | ({1} != {1})) ? {0} : {1}", "fmax": "(({0} >= {1}) | ({1} != {1})) ? {0} : {1}",
})  # fmt: skip

LIBRARY = MappingProxyType({
    "exp": "exp", "log": "log", "pow": "pow", "constpow": "pow", "tan": "tan", "asin": "asin", "acos": "acos",
    "atan": "atan", "atan2": "atan2", "fmod": "fmod", "remainder": "remainder", "hypot": "hypot",
    "erf": "erf", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "asinh": "asinh", "acosh": "acosh",
    "atanh": "atanh", "log1p": "log1p", "expm1": "expm1",
})  # fmt: skip

PRELUDE = """\
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__FMA__) || defined(__ARM_FEATURE_FMA)
#define FUSED(a, b, c) __builtin_fma(a, b, c)
#else
#define FUSED(a, b, c) ((a) * (b) + (c))
#endif

/* Sine and cosine for |x| <= 1e5, off by at most 2e-16 (absolute) up to 1e3 and beyond.
   pi/2 is split into 33 + 33 + 53 bits, so that the multiples subtracted first are exact; what is left,
   |r| <= pi/4, goes into polynomials that interpolate at Chebyshev nodes (truncation below 2e-17).
   Adding 1.5 * 2^52 rounds to an integer and leaves it in the low bits. */
static inline __attribute__((always_inline)) void sine_cosine(double x, double *sine, double *cosine)
{
    const double shifted = FUSED(x, 0.6366197723675814, 6755399441055744.0);
    const double turns = shifted - 6755399441055744.0;
    int64_t quarter;
    memcpy(&quarter, &shifted, sizeof quarter);
    double r = FUSED(-turns, 1.5707963267341256, x);
    r = FUSED(-turns, 6.077100506303966e-11, r);
    r = FUSED(-turns, 2.0222662487959506e-21, r);
    const double z = r * r;
    double p = FUSED(z, 1.591810123027412e-10, -2.5051131455427946e-08);
    p = FUSED(z, p, 2.755731610068303e-06);
    p = FUSED(z, p, -0.0001984126983675497);
    p = FUSED(z, p, 0.008333333333330946);
    p = FUSED(z, p, -0.16666666666666666);
    const double s = FUSED(r * z, p, r);
    double q = FUSED(z, -1.1382614868556325e-11, 2.0876146024689747e-09);
    q = FUSED(z, q, -2.7557317270560326e-07);
    q = FUSED(z, q, 2.4801587298763433e-05);
    q = FUSED(z, q, -0.0013888888888887395);
    q = FUSED(z, q, 0.041666666666666664);
    const double c = FUSED(z * z, q, FUSED(z, -0.5, 1.0));
    double a = (quarter & 1) ? c : s, b = (quarter & 1) ? s : c;
    uint64_t bits_a, bits_b;
    memcpy(&bits_a, &a, 8);
    memcpy(&bits_b, &b, 8);
    bits_a ^= (uint64_t)(quarter & 2) << 62;
    bits_b ^= (uint64_t)((quarter + 1) & 2) << 62;
    memcpy(sine, &bits_a, 8);
    memcpy(cosine, &bits_b, 8);
}

/* A column of the input as a block of its own, filled up with zeros. */
static __attribute__((noinline, unused)) void gather(
    double *restrict to, int room, const double *restrict from, int64_t step, int count)
{
    if (step == 1)
        memcpy(to, from, (size_t)count * sizeof(double));
    else
        for (int i = 0; i < count; i++) to[i] = from[i * step];
    for (int i = count; i < room; i++) to[i] = 0.0;
}

/* Both for a whole block; tells whether an angle was too far. */
static __attribute__((noinline, unused)) int64_t sines_cosines(
    int count, const double *restrict x, double *restrict sine, double *restrict cosine)
{
    int64_t beyond = 0;
    for (int i = 0; i < count; i++) {
        sine_cosine(x[i], &sine[i], &cosine[i]);
        beyond |= fabs(x[i]) > FAR_ANGLE ? (int64_t)1 : (int64_t)0;
    }
    return beyond;
}
"""


@dataclass(frozen=True, slots=True)
class _Stage:
    """Steps that run one after the other, in one loop if they are arithmetic."""

    library: bool
    steps: tuple[int, ...]


def c_source(tape: Tape, uniform_inputs: Sequence[bool]) -> str:
    """C text of `tape`, where `uniform_inputs` says which inputs are the same in all rows.

    It defines ENTRY(rows, inputs, row_strides, column_strides, outputs, output_strides, far): strides count
    doubles, `far` has a byte for each block of BLOCK rows, set where an angle went beyond FAR_ANGLE.
    Raises `UnsupportedOperation` for an operation that has no C form.
    """
    uniform = tape.uniform_nodes(uniform_inputs)
    stages = _stages(tape, uniform)
    stage_of = {step: k for k, stage in enumerate(stages) for step in stage.steps}
    stored = _stored(tape, stages, stage_of)
    columns = [k for k, node in enumerate(tape.nodes) if node.op == "input" and not uniform[k]]
    block = _block_rows(len(stored) + len(columns))

    scalar: list[str] = []
    for k, node in enumerate(tape.nodes):
        if not uniform[k] or node.op == "const":
            continue
        if node.op == "input":
            source, column = node.source
            scalar.append(f"    const double v{k} = inputs[{source}][{column} * column_strides[{source}]];")
        else:
            value = _value(tape, k, [_scalar_name(tape, arg) for arg in node.args])
            scalar.append(f"    const double v{k} = {value};")

    names = [*(f"a{k}" for k in sorted([*columns, *stored])), "unused"]
    body = [f"        double {name}[{block}] __attribute__((aligned(64)));" for name in names]
    for k in columns:
        source, column = tape.nodes[k].source
        at = f"inputs[{source}] + start * row_strides[{source}] + {column} * column_strides[{source}]"
        body.append(f"        gather(a{k}, {block}, {at}, row_strides[{source}], count);")
    for number, stage in enumerate(stages):
        body += _stage_text(tape, uniform, stage, number, stage_of, stored, block)
    for k, node in enumerate(node for output in tape.outputs for node in output):
        output, column = _output_of(tape, k)
        to = f"outputs[{output}] + {column} * output_strides[{output}] + start"
        if uniform[node]:
            body.append(f"        for (int i = 0; i < count; i++) ({to})[i] = {_scalar_name(tape, node)};")
        else:
            body.append(f"        memcpy({to}, a{node}, (size_t)count * sizeof(double));")

    return "\n".join(
        [
            f"#define FAR_ANGLE {FAR_ANGLE}",
            PRELUDE,
            f"void {ENTRY}(int64_t rows, const double *const *inputs, const int64_t *row_strides,",
            "    const int64_t *column_strides, double *const *outputs, const int64_t *output_strides,",
            "    unsigned char *far)",
            "{",
            *scalar,
            f"    for (int64_t start = 0; start < rows; start += {block}) {{",
            f"        const int count = rows - start < {block} ? (int)(rows - start) : {block};",
            "        int64_t beyond = 0;",
            *body,
            f"        far[start / {BLOCK}] |= beyond != 0;",
            "    }",
            "}",
            "",
        ]
    )


def _stages(tape: Tape, uniform: Sequence[bool]) -> list[_Stage]:
    """The steps that vary from row to row, arithmetic and calls of the library in turn."""
    level: list[int] = []
    groups: dict[tuple[int, bool], list[int]] = {}
    angles = {node.args[0] for node in tape.nodes if node.op in ("sin", "cos")}
    called = {*LIBRARY, "sin", "cos"} if len(angles) > MOST_INLINE_ANGLES else LIBRARY.keys()
    for k, node in enumerate(tape.nodes):
        depth = max((level[arg] for arg in node.args), default=0)
        if uniform[k] or node.op == "input":
            level.append(0)
            continue
        library = node.op in called
        groups.setdefault((depth, library), []).append(k)
        level.append(depth + library)
    return [
        _Stage(library, tuple(steps[start : start + LONGEST_STAGE]))
        for (_, library), steps in sorted(groups.items())
        for start in range(0, len(steps), LONGEST_STAGE)
    ]


def _stored(tape: Tape, stages: Sequence[_Stage], stage_of: dict[int, int]) -> set[int]:
    """Steps whose values outlive their stage, so that they need an array."""
    stored = {node for output in tape.outputs for node in output if node in stage_of}
    for number, stage in enumerate(stages):
        if stage.library:
            stored.update(stage.steps)
        for step in stage.steps:
            args = tape.nodes[step].args
            stored.update(arg for arg in args if arg in stage_of and stage_of[arg] != number)
    return stored


def _block_rows(arrays: int) -> int:
    """Rows in a block: a power of two that keeps the arrays on the stack below about 128 KiB."""
    rows = BLOCK
    while rows > 16 and rows * arrays > 1 << 14:
        rows //= 2
    return rows


def _stage_text(
    tape: Tape,
    uniform: Sequence[bool],
    stage: _Stage,
    number: int,
    stage_of: dict[int, int],
    stored: set[int],
    block: int,
) -> list[str]:
    def name(k: int) -> str:
        if uniform[k]:
            return _scalar_name(tape, k)
        return f"v{k}" if stage_of.get(k) == number and not stage.library else f"a{k}[i]"

    loop = f"        for (int i = 0; i < {block}; i++) {{"
    lines: list[str] = []
    angles: set[int] = set()
    of = {(tape.nodes[step].op, tape.nodes[step].args[0]): step for step in stage.steps}
    for step in stage.steps:
        node = tape.nodes[step]
        args = [name(arg) for arg in node.args]
        if stage.library and node.op in ("sin", "cos"):
            angle = node.args[0]
            if angle not in angles:
                angles.add(angle)
                to = [f"a{of[op, angle]}" if (op, angle) in of else "unused" for op in ("sin", "cos")]
                lines.append(f"        beyond |= sines_cosines({block}, a{angle}, {to[0]}, {to[1]});")
        elif stage.library:
            lines += [loop, f"            a{step}[i] = {_value(tape, step, args)};", "        }"]
        elif node.op in ("sin", "cos"):
            angle = node.args[0]
            if angle not in angles:
                angles.add(angle)
                lines += [
                    f"            double s{angle}, c{angle}; sine_cosine({args[0]}, &s{angle}, &c{angle});",
                    f"            beyond |= fabs({args[0]}) > FAR_ANGLE ? (int64_t)1 : (int64_t)0;",
                ]
            lines.append(f"            const double v{step} = {node.op[0]}{angle};")
        else:
            lines.append(f"            const double v{step} = {_value(tape, step, args)};")
        if step in stored and not stage.library:
            lines.append(f"            a{step}[i] = v{step};")
    return lines if stage.library else [loop, *lines, "        }"]


def _scalar_name(tape: Tape, k: int) -> str:
    return literal(tape.nodes[k].value) if tape.nodes[k].op == "const" else f"v{k}"


def _value(tape: Tape, k: int, args: Sequence[str]) -> str:
    op = tape.nodes[k].op
    if op in FORMULAS:
        return FORMULAS[op].format(*args)
    if op in LIBRARY or op in ("sin", "cos"):
        return f"{LIBRARY.get(op, op)}({', '.join(args)})"
    raise UnsupportedOperation(f"the operation {op} has no form in C")


def _output_of(tape: Tape, component: int) -> tuple[int, int]:
    """Output and column that a component of the stacked outputs belongs to."""
    output = 0
    while component >= len(tape.outputs[output]):
        component -= len(tape.outputs[output])
        output += 1
    return output, component
