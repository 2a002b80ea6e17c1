"""What pyproject.toml cannot say: the wheel carries the core's sources, which stand beside the package.

They get the checkout's own layout below meissner/sources (meissner.builds.toolchain.ROOT).
"""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py


class WithSources(build_py):
    def run(self):
        super().run()
        if not self.editable_mode:
            for folder in ("rtl", "constraints", "host", "ros2"):
                into = Path(self.build_lib) / "meissner/sources" / folder
                shutil.copytree(Path(__file__).parent / folder, into, dirs_exist_ok=True)


setup(cmdclass={"build_py": WithSources})
