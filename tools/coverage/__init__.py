"""Which features of Blender Gradus renders as Cycles does: one small scene per feature, rendered by both.

    python3 -m coverage     (see __main__.py; `make coverage` runs it)

`families/` finds the features in Blender's own descriptions of its types, so that those of a new version appear by
themselves; `worker.py` renders them inside a Blender, and `document.py` writes docs/coverage.md.
"""
