"""Reports with one digit altered, as somebody would with a PDF editor: one glyph of a page in place of another."""

import re
from io import BytesIO
from typing import Any

from pikepdf import Array, ContentStreamInstruction, Operator, Page, Pdf, String, parse_content_stream
from pikepdf import unparse_content_stream as written

PAIR = re.compile(r"<([0-9a-fA-F]{4})>\s*<([0-9a-fA-F]{4})>")
Letters = dict[str, dict[int, str]]


def count_of_digits(content: bytes) -> int:
    """Number of the digits that a report shows as text."""
    with Pdf.open(BytesIO(content)) as pdf:
        return sum(len(_digits(_instructions(page), _letters(page))) for page in pdf.pages)


def with_digit_altered(content: bytes, number: int) -> tuple[bytes, str]:
    """The report with that digit altered, and the place where it stands, such as `page 2`."""
    with Pdf.open(BytesIO(content)) as pdf:
        for place, page in enumerate(pdf.pages, 1):
            instructions, letters = _instructions(page), _letters(page)
            digits = _digits(instructions, letters)
            if number >= len(digits):
                number -= len(digits)
                continue
            row, at, font = digits[number]
            instructions[row] = _altered(instructions[row], at, letters[font])
            page.Contents = pdf.make_stream(written(instructions))
            packed = BytesIO()
            pdf.save(packed)
            return packed.getvalue(), f"page {place}"
    raise IndexError(number)


def with_blank_page(content: bytes) -> bytes:
    """The report with a page behind it that has no text."""
    with Pdf.open(BytesIO(content)) as pdf:
        pdf.add_blank_page()
        return _saved(pdf)


def with_creator(content: bytes, name: str) -> bytes:
    """The report with another name of the program that set it."""
    with Pdf.open(BytesIO(content)) as pdf:
        pdf.docinfo["/Creator"] = name
        return _saved(pdf)


def _saved(pdf: Pdf) -> bytes:
    packed = BytesIO()
    pdf.save(packed)
    return packed.getvalue()


def _instructions(page: Page) -> list[Any]:
    return list(parse_content_stream(page))


def _letters(page: Page) -> Letters:
    """Letters of the glyphs of each font of a page."""
    fonts: Any = page.resources.get("/Font", {})
    return {
        str(name): {int(a, 16): chr(int(b, 16)) for a, b in PAIR.findall(font.ToUnicode.read_bytes().decode())}
        for name, font in fonts.items()
    }


def _digits(instructions: list[Any], letters: Letters) -> list[tuple[int, int, str]]:
    """Digits of a page: instruction, place among its glyphs, and font."""
    result, font = [], ""
    for row, instruction in enumerate(instructions):
        if str(instruction.operator) == "Tf":
            font = str(instruction.operands[0])
        for at, glyph in enumerate(_glyphs(instruction)):
            if letters.get(font, {}).get(glyph, "") in "0123456789" and glyph in letters[font]:
                result.append((row, at, font))
    return result


def _parts(instruction: Any) -> list[Any]:
    if str(instruction.operator) not in ("Tj", "TJ"):
        return []
    view = instruction.operands[0]
    return list(view) if isinstance(view, Array) else [view]


def _glyphs(instruction: Any) -> list[int]:
    texts = b"".join(bytes(part) for part in _parts(instruction) if isinstance(part, String))
    return [int.from_bytes(texts[k : k + 2]) for k in range(0, len(texts) - 1, 2)]


def _altered(instruction: Any, at: int, letters: dict[int, str]) -> ContentStreamInstruction:
    """The instruction with another digit of its font at a place among its glyphs."""
    before = _glyphs(instruction)[at]
    after = next(glyph for glyph, letter in letters.items() if letter in "0123456789" and letter != letters[before])
    parts, passed = list[Any](), 0
    for part in _parts(instruction):
        if isinstance(part, String):
            text, start = bytes(part), 2 * at - passed
            passed += len(text)
            if 0 <= start < len(text):
                part = String(text[:start] + after.to_bytes(2) + text[start + 2 :])
        parts.append(part)
    return ContentStreamInstruction([Array(parts)], Operator("TJ"))
