"""Executes notebooks in this environment and refuses those that are kept with outputs: python run_notebooks.py NAME.ipynb ..."""

import sys
import tempfile

import nbformat
from nbclient import NotebookClient

for path in sys.argv[1:]:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    kept = [cell for cell in notebook.cells if cell.cell_type == "code" and (cell.outputs or cell.execution_count)]
    if kept:
        sys.exit(f"{path}: has {len(kept)} cells with outputs; strip them before it is committed")
    with tempfile.TemporaryDirectory() as folder:
        NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": folder}}).execute()
    shown = sum(len(cell.outputs) for cell in notebook.cells if cell.cell_type == "code")
    print(f"{path}: {len(notebook.cells)} cells, {shown} outputs")
