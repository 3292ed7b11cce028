"""Standard streams that are closed or full, and names that a terminal would obey."""

import pytest


@pytest.mark.parametrize(
    ("line", "status", "said"),
    [
        ("effects list >&-", 2, "standard output: cannot be written: Bad file descriptor\n"),
        pytest.param(
            "--help >&-", 2, "standard output: cannot be written: Bad file descriptor\n", marks=pytest.mark.slow
        ),
        ("effects list 2>&- >/dev/null", 0, ""),
        pytest.param("evaluate missing.yaml 2>&-", 2, "", marks=pytest.mark.slow),
        ("evaluate missing.yaml 2>/dev/full", 2, ""),
        pytest.param("evaluate missing.yaml >&-", 2, "missing.yaml: there is no such file\n", marks=pytest.mark.slow),
        pytest.param("effects list <&- >/dev/null", 0, "", marks=pytest.mark.slow),
    ],
)
def test_closed_and_full_streams(process, line, status, said):
    done = process(f'"$PYTHON" -m linkwright {line}')
    assert (done.returncode, done.stdout, done.stderr) == (status, "", said)


def test_a_result_goes_to_its_file_where_no_stream_is_open(process, bench):
    """And nothing that is printed comes into a file that got the number of a closed stream."""
    process('"$PYTHON" -m linkwright effects list --json result.json <&- >&- 2>&-')
    assert (bench / "result.json").read_text().startswith("{")
    assert (bench / "result.json").read_text().endswith("}\n")


def test_names_are_shown_and_not_obeyed(linkwright, bench):
    """The name of a file in an error and in what is written."""
    name = "a\x1b[31m\x07b"
    status, _, err = linkwright("evaluate", f"{name}.yaml")
    assert status == 2
    assert err == "a\\x1b[31m\\x07b.yaml: there is no such file\n"
    (bench / f"{name}.yaml").write_bytes((bench / "arm.yaml").read_bytes())
    status, out, _ = linkwright("evaluate", f"{name}.yaml", "--json", f"{name}.json")
    assert status == 0
    assert "written: a\\x1b[31m\\x07b.json" in out
    assert "\x1b" not in out


@pytest.mark.slow
def test_the_solver_does_not_talk(process, bench):
    """Sizes at which a trial step leaves what can be computed: CasADi would warn of each."""
    path = bench / "problem.yaml"
    path.write_text(path.read_text().replace("[20 mm, 80 mm]", "[20 mm, 9 km]"))
    done = process('"$PYTHON" -m linkwright optimize problem.yaml >/dev/null')
    assert (done.returncode, done.stderr) == (0, "")
