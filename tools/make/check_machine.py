"""Check for prerequisites that PyPI does not provide; print the command that installs them and stop."""

import shutil
import sys
import sysconfig
from pathlib import Path


def main():
    version = f"{sys.version_info.major}.{sys.version_info.minor}"
    if sys.version_info < (3, 11):  # noqa: UP036 - the interpreter may be any that make was given
        sys.exit(f"meissner needs Python 3.11 or newer; this is {version}. Try: make PYTHON=python3.11 ...")
    packages = []
    try:
        import ensurepip  # noqa: F401 - its presence is the check: Debian ships venv without it
    except ImportError:
        packages.append(f"python{version}-venv")
    library = sysconfig.get_config_var("INSTSONAME") or sysconfig.get_config_var("LDLIBRARY") or ""
    folders = [sysconfig.get_config_var(name) for name in ("LIBDIR", "LIBPL")]
    multiarch = sysconfig.get_config_var("MULTIARCH")
    folders += [f"/usr/lib/{multiarch}"] if multiarch else []
    if ".so" not in library or not any(folder and (Path(folder) / library).exists() for folder in folders):
        packages.append(f"libpython{version}")  # cocotb embeds Python, so it must be a shared library
    packages += [tool for tool in ("g++", "make") if shutil.which(tool) is None]
    if packages:
        sys.exit(f"Some parts are missing that PyPI does not have. Run: apt install {' '.join(packages)}")


if __name__ == "__main__":
    main()
