"""How a command ends: status, what it printed, and what it printed as an error."""


def ok(result):
    status, out, err = result
    assert (status, err) == (0, "")
    return out


def wrong(result, words):
    status, out, err = result
    assert status == 2
    assert words in err
    assert err.count("\n") == 1
    assert out == ""
