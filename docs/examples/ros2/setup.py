from setuptools import setup

PACKAGE = "posefusion_ros"

setup(
    name=PACKAGE,
    version="0.1.0",
    packages=[PACKAGE],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (f"share/{PACKAGE}", ["package.xml"]),
        (f"share/{PACKAGE}/launch", ["launch/posefusion.launch.py"]),
    ],
    install_requires=["setuptools"],
    license="MIT",
    entry_points={"console_scripts": ["slam = posefusion_ros.node:main"]},
)
