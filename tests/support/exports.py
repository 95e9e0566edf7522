"""Records the add-on's exports during a render, in order."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any

import pytest
from gradus import store

from .simulations import Places, places


class Exports:
    """Records the frame and the positions of objects by view layer. `before` is called at each export and may raise."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.of: dict[str, list[tuple[int, Places]]] = defaultdict(list)
        self.before: Callable[[int], None] = lambda _frame: None
        sync = store.Session.sync

        def note(session: store.Session, depsgraph: Any, *arguments: Any) -> Any:
            frame = depsgraph.scene_eval.frame_current
            self.before(frame)
            self.of[depsgraph.view_layer.name].append((frame, places(depsgraph)))
            return sync(session, depsgraph, *arguments)

        monkeypatch.setattr(store.Session, "sync", note)

    def frames(self, layer: str = "ViewLayer") -> list[int]:
        return [frame for frame, _ in self.of[layer]]
