"""Builds the wheel of the Python package: the PEP 517 backend of pyproject.toml. Python's standard library only.

SOUPLE_BUILD_DIR names a folder of CMake with SOUPLE_WITH_PYTHON=ON, whose library is used as it is. Without it the library is
built in build/wheel: with its own threads and fmt inside, without assimp, oneTBB and OpenVDB.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "souple"


def version():
    return re.search(r"^project\(souple VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text(), re.M).group(1)


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def metadata():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    return (f"Metadata-Version: 2.1\nName: souple\nVersion: {version()}\n"
            "Summary: Position-based dynamics of cloth, soft bodies, ropes, rigid bodies, grains and fluids\n"
            "Requires-Python: >=3.9\nRequires-Dist: numpy\nDescription-Content-Type: text/markdown\n\n" + text)


def run(*command):
    print("+", *command, flush=True)
    if subprocess.run(command).returncode != 0:
        raise SystemExit(f"souple: {command[0]} failed; docs/python.md lists what building needs")


def build_library():
    """Returns the module that CMake has built."""
    folder = os.environ.get("SOUPLE_BUILD_DIR")
    if not shutil.which("cmake"):
        raise SystemExit("souple: cmake is not installed (Debian: script/bootstrap installs what is missing)")
    if not folder:
        folder = str(ROOT / "build" / "wheel")
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        off = [f"-DSOUPLE_{part}=OFF" for part in ("BUILD_APP", "BUILD_TESTS", "BUILD_BENCHMARKS", "RADIUM",
                                                   "INSTALL", "WITH_TBB", "WITH_ASSIMP")]
        run("cmake", "-S", str(ROOT), "-B", folder, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DSOUPLE_WITH_PYTHON=ON",
            "-DSOUPLE_FMT_HEADER_ONLY=ON", f"-DPython_EXECUTABLE={sys.executable}", *off)
    run("cmake", "--build", folder, "--parallel", str(os.cpu_count() or 1), "--target", "souple_python")
    modules = sorted((pathlib.Path(folder) / "python" / "souple").glob(f"_souple*{sysconfig.get_config_var('SOABI')}*.so"))
    if len(modules) != 1:
        raise SystemExit(f"souple: {folder} has no module for {sys.executable}; it was configured for another Python")
    return modules[0]


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    module = build_library()
    info = f"souple-{version()}.dist-info"
    files = {f"souple/{file.name}": file.read_bytes() for pattern in ("*.py", "py.typed") for file in sorted(PACKAGE.glob(pattern))}
    for made in (module, *sorted(module.parent.glob("_souple/*.pyi"))):
        files[f"souple/{made.relative_to(module.parent)}"] = made.read_bytes()
    files[f"{info}/METADATA"] = metadata().encode()
    files[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: souple\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    name = f"souple-{version()}-{tag()}.whl"
    records = []
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            wheel.writestr(path, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            records.append(f"{path},sha256={digest},{len(data)}\n")
        wheel.writestr(f"{info}/RECORD", "".join(records) + f"{info}/RECORD,,\n")
    return name


def build_sdist(sdist_directory, config_settings=None):
    """The files that git tracks, for `python3 -m build --sdist`."""
    base = f"souple-{version()}"
    names = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.split("\0")
    with tarfile.open(pathlib.Path(sdist_directory) / f"{base}.tar.gz", "w:gz") as archive:
        for name in filter(None, names):
            archive.add(ROOT / name, f"{base}/{name}", recursive=False)
    return f"{base}.tar.gz"
