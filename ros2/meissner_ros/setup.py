from glob import glob

from setuptools import setup

NAME = "meissner_ros"

setup(
    name=NAME,
    version="0.1.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", glob("launch/*.launch.py")),
        (f"share/{NAME}/config", glob("config/*.yaml")),
    ],
    install_requires=["setuptools"],
    zip_safe=True,
    maintainer="The Meissner project",
    maintainer_email="meissner@example.org",
    description="A Meissner core as a ROS 2 node",
    license="Apache-2.0",
    entry_points={"console_scripts": [f"meissner = {NAME}.node:main"]},
)
