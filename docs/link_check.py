"""Whether every link inside the built site leads somewhere: to a file that is there, and to a place in it."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

__all__ = ["broken_links"]


class _Page(HTMLParser):
    """What a page points to, and what in it can be pointed to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.names: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.targets += [one for key in ("href", "src") if (one := given.get(key))]
        self.names.update(one for key in ("id", "name") if (one := given.get(key)))


def broken_links(site: Path) -> list[str]:
    """``page: target`` of each link inside ``site`` that leads nowhere; links to other sites are left alone."""
    pages = {path.resolve(): _Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    return [
        f"{path.relative_to(site.resolve())}: {target}"
        for path, page in pages.items()
        for target in dict.fromkeys(page.targets)
        if not _leads_somewhere(path, target, pages)
    ]


def _leads_somewhere(page: Path, target: str, pages: dict[Path, _Page]) -> bool:
    link = urlsplit(target)
    if link.scheme or link.netloc:
        return True
    place = (page.parent / unquote(link.path)).resolve() if link.path else page
    if not place.is_file():
        return False
    return not link.fragment or place not in pages or unquote(link.fragment) in pages[place].names
