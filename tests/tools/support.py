"""What the tests of the tools share."""
import sys
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

TOOLS = Path(__file__).resolve().parents[2] / "tools"


def load(tool):
    """A tool as a module, for its functions."""
    loader = SourceFileLoader(tool, str(TOOLS / tool))
    module = module_from_spec(spec_from_loader(tool, loader))
    loader.exec_module(module)
    return module


def write_program(file, text):
    """A Python program that stands in for a real one; its first line is #!{python}, other braces are doubled."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text.format(python=sys.executable))
    file.chmod(0o755)
