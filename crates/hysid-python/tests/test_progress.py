"""Progress is shown in a terminal and a notebook, nowhere else, and leaves nothing behind."""

import os
import re
import subprocess
import sys
import textwrap

import nbclient
import nbformat
import pytest

import hysid

FIT = """
    import numpy as np
    import hysid
    x = 3 * np.sin(np.linspace(0, 60, 2000))
    model = hysid.fit(x, hysid.operators.stop(x, 1.0), model="xpnn", starts=1, epochs=100_000, stall=0, time_limit=2{more})
"""


def run_in_terminal(script, columns):
    """Text that a program writes to the terminal behind its stderr."""
    pty = pytest.importorskip("pty")
    import fcntl
    import struct
    import termios

    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    environment = {**os.environ, "TERM": "xterm"}
    script = textwrap.dedent(script)
    child = subprocess.Popen([sys.executable, "-c", script], stderr=theirs, stdout=subprocess.PIPE, env=environment)
    os.close(theirs)
    written = b""
    try:
        while part := os.read(ours, 4096):
            written += part
    except OSError:
        # The other end is closed.
        pass
    assert child.wait() == 0, written
    os.close(ours)
    return written.decode()


def seconds(words):
    """The remaining time of a line."""
    found = re.search(r"(\d+) s left", words)
    return 5 if "a few seconds left" in words else int(found[1]) if found else None


@pytest.mark.parametrize("columns", [40, 100])
def test_a_line_fits_the_terminal_and_is_erased(columns):
    written = run_in_terminal(FIT.format(more=""), columns)
    assert "\n" not in written
    lines = written.split("\r")
    assert any(" %" in line for line in lines)
    assert ("fitting xpnn" in written) == (columns == 100)
    assert all(len(line) < columns for line in lines)
    times = [time for time in map(seconds, lines) if time is not None]
    assert times and times == sorted(times, reverse=True)
    assert lines[-1] == "" and lines[-2].strip() == "", "the line is erased"


def test_nothing_is_shown_where_it_is_not_wanted():
    assert run_in_terminal(FIT.format(more=", progress=False"), 80) == ""
    assert run_in_terminal(FIT.format(more=", progress=None"), 80) == ""
    through_pipe = [sys.executable, "-c", textwrap.dedent(FIT.format(more=""))]
    assert subprocess.run(through_pipe, capture_output=True, check=True).stderr == b""
    in_thread = FIT.format(more="").replace("    model = ", "    work = lambda: ") + """
    import threading
    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
"""
    assert run_in_terminal(in_thread, 80) == ""


def test_a_comparison_shows_all_its_models():
    script = """
        import numpy as np
        import hysid
        x = 3 * np.sin(np.linspace(0, 60, 2000))
        names = ["xpnn", "gpnn", "masing"]
        rows = hysid.compare(x, hysid.operators.stop(x, 1.0), models=names, time_limit=1.5, threads=1)
        assert len(rows) == 3
    """
    written = run_in_terminal(script, 100)
    assert "model 1 of 3" in written and "\n" not in written
    shares = [int(share) for share in re.findall(r"(\d+) %", written)]
    assert shares == sorted(shares)


def test_a_comparison_may_be_ended(spring_and_slider):
    told = []

    def enough(progress):
        told.append(progress)
        return True

    names = ["xpnn", "gpnn"]
    rows = hysid.compare(*spring_and_slider, models=names, time_limit=60, threads=1, progress=enough)
    assert all(progress.is_part and 0.0 <= progress.done <= 1.0 for progress in told)
    assert [row.error for row in rows if row.model is None] == ["not fitted: the comparison was ended before"]


def test_a_notebook_shows_a_line_that_goes_away(tmp_path):
    code = textwrap.dedent(FIT.format(more="")) + textwrap.dedent("""
        from IPython.display import display
        shown = []
        import hysid._progress_line as line
        publish = line._Notebook._publish
        line._Notebook._publish = lambda self, content: (shown.append(content), publish(self, content))
        hysid.fit(x, x, model="xpnn", starts=1, epochs=100_000, stall=0, time_limit=2)
        print(len(shown), "<progress" in shown[0]["text/html"], shown[0]["text/plain"], shown[-1])
    """)
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(code)])
    nbclient.NotebookClient(book, timeout=120, kernel_name="python3").execute()
    displays = [output for output in book.cells[0].outputs if output.output_type == "display_data"]
    assert displays and all(output.data == {"text/plain": "", "text/html": ""} for output in displays), displays
    (stream,) = [output for output in book.cells[0].outputs if output.get("name") == "stdout"]
    count, has_bar, text = stream.text.split(" ", 2)
    assert int(count) > 3 and has_bar == "True"
    assert "fitting xpnn" in text and text.strip().endswith("{'text/plain': '', 'text/html': ''}")
    assert not [output for output in book.cells[0].outputs if output.get("name") == "stderr"]


def test_progress_is_true_false_or_a_function(spring_and_slider):
    for work in (hysid.fit, hysid.validate, hysid.compare):
        with pytest.raises(TypeError, match="progress 'bar': True, False or a function is needed"):
            work(*spring_and_slider, progress="bar")
