"""The workflow that builds wheels: it can be read, is pinned, has every platform, and tests what it builds."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def jobs():
    text = (ROOT / ".github" / "workflows" / "wheels.yml").read_text(encoding="utf-8")
    return yaml.safe_load(text)["jobs"]


def test_every_platform_has_a_wheel(jobs):
    targets = {build["target"] for build in jobs["wheel"]["strategy"]["matrix"]["include"]}
    assert targets == {
        "x86_64-unknown-linux-gnu",
        "aarch64-unknown-linux-gnu",
        "aarch64-apple-darwin",
        "x86_64-apple-darwin",
        "x86_64-pc-windows-msvc",
    }
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    assert 'features = ["abi3-py310"]' in manifest, "one wheel serves every Python"


def test_what_is_used_is_pinned_and_what_is_built_is_tested(jobs):
    for job in jobs.values():
        used = [step["uses"] for step in job["steps"] if "uses" in step]
        assert used and all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40}", one) for one in used)
        scripts = [step["run"] for step in job["steps"] if "run" in step]
        assert all("installed.py" in script for script in scripts) and scripts
        built = [step["with"] for step in job["steps"] if step.get("uses", "").startswith("PyO3/maturin-action@")]
        (path,) = re.findall(r"--manifest-path (\S+)", built[0]["args"])
        assert (ROOT / path).exists()
    versions = [step["with"]["python-version"] for step in jobs["wheel"]["steps"] if "python-version" in step.get("with", {})]
    project = (ROOT / "crates" / "hysid-python" / "pyproject.toml").read_text(encoding="utf-8")
    assert f'requires-python = ">={versions[0]}"' in project and len(versions) == 2


def test_the_package_has_the_licences_of_the_repository():
    package = ROOT / "crates" / "hysid-python"
    for name in ("LICENSE-MIT", "LICENSE-APACHE"):
        assert (package / name).read_bytes() == (ROOT / name).read_bytes()


def test_the_script_that_tests_an_installed_package_passes(capsys):
    import runpy

    runpy.run_path(str(Path(__file__).with_name("installed.py")))
    assert "works: <hysid.Model masing" in capsys.readouterr().out
