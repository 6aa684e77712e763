"""Lets all rivals denoise the frames of one scene, in turns, and judges their pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from statistics import median

import numpy as np

from svgf_cl.compare import imagery
from svgf_cl.compare.footage import Footage
from svgf_cl.compare.halves import Pair
from svgf_cl.compare.imagery import Piece
from svgf_cl.compare.judge import Judge, switches_in
from svgf_cl.compare.measures import MEASURES, value
from svgf_cl.compare.metrics import psnr
from svgf_cl.compare.page import Entry, Scene
from svgf_cl.compare.rivals import Maker
from svgf_cl.compare.view import View
from svgf_cl.frame import Frame
from svgf_cl.io.display import Bytes, Linear, display, to_bytes
from svgf_cl.io.panels import worst_piece

NOISY, REFERENCE = "noisy", "reference"


@dataclass
class Gallery:
    """The parts of one rival's pictures that the page shows.

    Parameters
    ----------
    piece : Piece
    pieces, rows : list of (h, w, 3) and (W, 3) 8-bit
        One of each for every judged frame.
    shown : (H, W, 3) 8-bit, optional
        The frame that is shown whole.
    """

    piece: Piece
    pieces: list[Bytes] = field(default_factory=list)
    rows: list[Bytes] = field(default_factory=list)
    shown: Bytes | None = None

    def see(self, picture: Bytes, *, whole: bool) -> None:
        """Keep the parts of the next picture that are shown."""
        self.pieces.append(self.piece.of(picture).copy())
        self.rows.append(picture[self.piece.row].copy())
        if whole:
            self.shown = picture


@dataclass
class Contestant:
    """A rival in a contest, with its judge, its pictures and its times.

    Parameters
    ----------
    maker : Maker
    judge : Judge
    gallery : Gallery, optional
        Set at the first judged frame.
    times : list of float, ms
        Times of the judged frames.
    """

    maker: Maker
    judge: Judge
    gallery: Gallery | None = None
    times: list[float] = field(default_factory=list)

    def see(self, picture: Linear, view: View) -> None:
        """Judge the picture of a frame."""
        self.judge.see(picture, view)
        if self.maker.milliseconds is not None:
            self.times.append(self.maker.milliseconds)


def compete(footage: Footage, makers: Mapping[str, Maker], exposure: float, advance: Callable[[], None]) -> Scene:
    """Let all rivals denoise a footage frame by frame, and judge them.

    Parameters
    ----------
    footage : Footage
    makers : mapping of str to Maker
        Rivals that have not denoised any frame yet. The first one that is not the noisy input is under test: clips show
        the piece where it is worst.
    exposure : float, stops
        Exposure of all pictures that are shown, and of display-referred measures.
    advance : callable
        Called ``footage.steps + len(footage.numbers)`` times.

    Returns
    -------
    Scene
        Its entries are in the order of `makers`; the reference is the last.
    """
    judged = list(footage.judged)
    if not judged:
        raise ValueError(f"{footage.name}: expected a reference of at least one frame")
    truths = footage.truths(advance)
    shown = judged[len(judged) // 2]
    switches = switches_in([truths[number] for number in judged])
    contestants = {name: Contestant(maker, Judge(switches)) for name, maker in makers.items()}
    reference = None
    before: tuple[int, Frame] | None = None
    for number, frame in zip(footage.numbers, footage.frames(), strict=True):
        made = {name: np.asarray(each.maker.denoise(frame)) for name, each in contestants.items()}
        if number in truths:
            earlier = (before[1], truths[before[0]]) if before and before[0] == number - 1 else None
            view = View(frame, truths[number], footage.jitter, earlier, exposure)
            wanted = to_bytes(view.truth, exposure)
            pictures = {name: to_bytes(picture, exposure) for name, picture in made.items()}
            if reference is None:
                reference = Gallery(piece_to_show(pictures, wanted))
            reference.see(wanted, whole=number == shown)
            for name, each in contestants.items():
                each.see(made[name], view)
                each.gallery = each.gallery or Gallery(reference.piece)
                each.gallery.see(pictures[name], whole=number == shown)
            before = number, frame
        advance()
    if reference is None or reference.shown is None:
        raise ValueError(f"{footage.name}: expected a frame for each truth")
    wanted = reference.shown
    entries = [entry(name, each, wanted) for name, each in contestants.items()]
    return Scene(
        name=footage.name,
        note=note_of(footage, truths, exposure),
        frames=judged,
        shown=shown,
        size=footage.shape,
        crop=reference.piece.crop,
        row=reference.piece.row,
        entries=[*entries, reference_entry(reference, wanted)],
        reference=REFERENCE,
        noisy=NOISY if NOISY in makers else None,
    )


def piece_to_show(pictures: Mapping[str, Bytes], wanted: Bytes) -> Piece:
    """Return the piece where the first rival after the noisy input is worst."""
    tested = next((name for name in pictures if name != NOISY), NOISY)
    rows, columns = worst_piece(pictures[tested], wanted, imagery.PIECES)
    return Piece(rows, columns)


def entry(name: str, contestant: Contestant, wanted: Bytes) -> Entry:
    """Return one rival's entry for the page."""
    gallery, judge = contestant.gallery, contestant.judge
    if gallery is None or gallery.shown is None:
        raise ValueError(f"{name}: expected a picture of the frame that is shown")
    found = judge.findings
    return Entry(
        rival=name,
        values={each.key: value(found, each.key) for each in MEASURES},
        curves=judge.curves,
        milliseconds=median(contestant.times) if contestant.times else None,
        picture=imagery.encoded(gallery.shown),
        heat=imagery.error_map(gallery.shown, wanted),
        **moving(gallery),
    )


def reference_entry(gallery: Gallery, wanted: Bytes) -> Entry:
    """Return the reference's entry for the page."""
    return Entry(REFERENCE, {}, {}, None, imagery.encoded(wanted), None, **moving(gallery))


def moving(gallery: Gallery) -> dict[str, bytes | None]:
    """Return the clip and the profile; None for both if there is only one frame."""
    if len(gallery.rows) < 2:
        return {"clip": None, "profile": None}
    return {"clip": imagery.clip(gallery.pieces), "profile": imagery.profile(gallery.rows)}


def note_of(footage: Footage, truths: Mapping[int, Pair], exposure: float) -> str:
    """Return the footage's own note, and how much the halves of the truth differ, if there are two."""
    apart = [psnr(display(first, exposure), display(second, exposure)) for first, second in truths.values()]
    noise = f"halves of the truth differ by {np.mean(apart):.1f} dB" if np.isfinite(apart).all() else ""
    return "; ".join(text for text in (footage.note, noise) if text)
