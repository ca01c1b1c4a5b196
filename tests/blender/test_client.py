import subprocess
import sys
from dataclasses import replace

import pytest

from cityx.blender.client import BlenderJob, run_worker
from cityx.errors import EngineError, MissingDependency
from cityx.system import blender_process
from cityx.system.blender_process import explain_missing


def test_a_missing_library_names_its_package():
    text = explain_missing("libSM.so.6: cannot open shared object file: No such file or directory")
    assert text.startswith("Blender needs the system library libSM, which is not installed.")
    assert "package libsm6 (Debian, Ubuntu) or libSM (Fedora)" in text


def test_a_missing_module_names_the_wheel():
    assert 'pip install "bpy' in explain_missing("No module named 'bpy'")


def scripted(monkeypatch, tmp_path, body):
    """Let the worker be a few lines of Python instead of Blender."""
    script = tmp_path / "worker.py"
    script.write_text(f"import json, os, sys, time\njob = json.load(open(sys.argv[1]))\n{body}")
    start = blender_process.subprocess.Popen
    monkeypatch.setattr(
        blender_process.subprocess,
        "Popen",
        lambda command, **rest: start([command[0], str(script), command[-1]], **rest),
    )
    return BlenderJob(tmp_path)


def test_progress_is_passed_on(monkeypatch, tmp_path):
    answer = {"files": [], "timings": {}, "peak_rss_mb": 1.0, "device": "CPU", "objects": 3}
    body = f"""print('chatter')
print('@cityx [0.5, "half"]')
json.dump({answer | {"blender": "4.5"}}, open(job['result'], 'w'))"""
    heard = []
    job = scripted(monkeypatch, tmp_path, body)
    result = run_worker(job, progress=lambda share, text: heard.append((share, text)))
    assert (heard, result.objects) == ([(0.0, "starting Blender"), (0.5, "half")], 3)


def test_a_hanging_worker_is_killed(monkeypatch, tmp_path):
    job = scripted(monkeypatch, tmp_path, "print('stuck', flush=True); time.sleep(60)")
    with pytest.raises(EngineError, match=r"stopped after 1 s[\s\S]*stuck"):
        run_worker(job, timeout_s=1)


def test_a_killed_worker_leaves_no_half_file(monkeypatch, tmp_path):
    half = "open(os.path.join(job['store'], '.a.partial.blend'), 'w').close(); time.sleep(60)"
    job = replace(scripted(monkeypatch, tmp_path, half), blend=tmp_path / "a.blend")
    with pytest.raises(EngineError):
        run_worker(job, timeout_s=1)
    assert [path.name for path in tmp_path.iterdir()] == ["worker.py"]


def test_a_crash_is_an_engine_error_with_the_last_words(monkeypatch, tmp_path):
    job = scripted(monkeypatch, tmp_path, "print('Segmentation', flush=True); os.abort()")
    with pytest.raises(EngineError, match=r"ended by signal 6[\s\S]*Segmentation"):
        run_worker(job)


def test_a_library_missing_in_the_worker_is_a_missing_dependency(monkeypatch, tmp_path):
    body = "json.dump({'missing': 'libX11.so.6: cannot open'}, open(job['result'], 'w'))"
    with pytest.raises(MissingDependency, match="libx11-6"):
        run_worker(scripted(monkeypatch, tmp_path, body))


@pytest.mark.blender
def test_a_folder_without_a_city_is_an_engine_error(tmp_path):
    with pytest.raises(EngineError, match="holds no city"):
        run_worker(replace(BlenderJob(tmp_path), gpu=False), timeout_s=120)


@pytest.mark.blender
@pytest.mark.skipif(sys.platform != "linux", reason="uses prctl")
def test_the_worker_ends_when_its_caller_is_killed():
    worker = "import os, time; from cityx.system.parents import end_with_parent as end; "
    worker += "end(os.getppid()); print(os.getpid(), flush=True); time.sleep(60)"
    caller = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {worker!r}])"
    process = subprocess.Popen([sys.executable, "-c", caller], stdout=subprocess.PIPE, text=True)
    with process.stdout as words:
        number = int(words.readline())
        process.kill()
        process.wait()
        assert words.read() == ""  # the pipe closes only when the worker has ended too
    assert number > 0
