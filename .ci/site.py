#!/usr/bin/env python3
"""Pages of the site: docs/ and the README, with what lies outside of them linked in the repository.

    site.py FOLDER                    stages the pages for mdbook
    site.py --check FOLDER            every link and anchor inside a built site leads somewhere
    site.py --readme README FOLDER    FOLDER/README.md, whose links lead somewhere without the repository beside it
"""
import re
import shutil
import sys
from html.parser import HTMLParser
from os.path import relpath
from pathlib import Path
from urllib.parse import unquote, urlsplit

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"(\]\()([^)\s]+)(\))")


def repository():
    return re.search(r'^repository = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)[1]


def linked(text, page, inside):
    """A page's text, whose links lead where `inside` says, and into the repository where it says nothing."""

    def moved(match):
        target, _, anchor = match[2].partition("#")
        if not target or "://" in target:
            return match[0]
        there = (page.parent / target).resolve()
        if not there.exists():
            sys.exit(f"error: {page.relative_to(ROOT)}: {target} is not there")
        kind = "tree" if there.is_dir() else "raw" if there.suffix in (".png", ".svg") else "blob"
        place = inside(there, target) or f"{repository()}/{kind}/main/{there.relative_to(ROOT).as_posix()}"
        return f"{match[1]}{place}{'#' + anchor if anchor else ''}{match[3]}"

    return LINK.sub(moved, text)


def staged(text, page):
    """A page of the site: its links lead to other pages of it, or into the repository."""
    docs = ROOT / "docs"
    here = docs if page == ROOT / "README.md" else page.parent

    def inside(there, _):
        if there == ROOT / "README.md":
            there = docs / "README.md"
        if not there.is_relative_to(docs):
            return None
        # A README becomes its folder's index.
        there = there.with_name("index.md") if there.name == "README.md" else there
        return Path(relpath(there, here)).as_posix()

    return linked(text, page, inside)


def readme(page, folder):
    """An archive's README: its links lead to what the archive holds, or into the repository."""
    inside = lambda _, target: target if (folder / target).exists() and ".." not in target else None
    (folder / "README.md").write_text(linked(page.read_text(), page, inside))


def stage(folder):
    shutil.copytree(ROOT / "docs", folder)
    for page in folder.rglob("*.md"):
        page.write_text(staged(page.read_text(), ROOT / "docs" / page.relative_to(folder)))
    (folder / "README.md").write_text(staged((ROOT / "README.md").read_text(), ROOT / "README.md"))


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors.update(attributes[key] for key in ("id", "name") if attributes.get(key))
        self.links += [attributes[key] for key in ("href", "src") if attributes.get(key)]


def check(folder):
    pages = {path: Page(path.read_text()) for path in folder.rglob("*.html") if path.name not in ("404.html", "print.html")}
    broken = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            there = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if there.is_dir():
                there /= "index.html"
            if not there.exists():
                broken.append(f"{path.relative_to(folder)}: {link}: no such page")
            elif parts.fragment and there in pages and unquote(parts.fragment) not in pages[there].anchors:
                broken.append(f"{path.relative_to(folder)}: {link}: no such heading")
    for line in broken:
        print(f"error: {line}")
    print(f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links, {len(broken)} broken")
    sys.exit(1 if broken or not pages else 0)


if sys.argv[1] == "--check":
    check(Path(sys.argv[2]).resolve())
elif sys.argv[1] == "--readme":
    readme(Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve())
else:
    stage(Path(sys.argv[1]).resolve())
