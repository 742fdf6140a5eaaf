#!/usr/bin/python3
"""The documentation as a site: check_site.py FOLDER

Builds it into FOLDER with --strict, without a network where the system lets us take it away, and looks at every page: links and headings that they name are
there, nothing comes from elsewhere, and what plain Markdown shows as a list, a table or code is one here, too. Ends with 77, skipped, where mkdocs is not installed.
"""
import os
import pathlib
import re
import subprocess
import sys
from html.parser import HTMLParser

ROOT = pathlib.Path(__file__).resolve().parent.parent


SHOWN_AS_IT_IS = {"pre", "code", "script", "style", "h1", "h2", "h3", "h4"}


class Page(HTMLParser):
    """What a page names, loads and links to."""

    def __init__(self, path):
        super().__init__()
        self.ids, self.links, self.loads, self.text, self.inside = set(), [], [], [], []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        told = dict(attrs)
        self.ids |= {told[key] for key in ("id", "name") if told.get(key)}
        if tag == "a" and told.get("href"):
            self.links.append(told["href"])
        elif tag in ("script", "img", "link", "iframe", "source", "object") and "canonical" not in told.get("rel", ""):
            self.loads += [told[key] for key in ("src", "href", "data") if told.get(key)]
        if tag in SHOWN_AS_IT_IS:
            self.inside.append(tag)

    def handle_endtag(self, tag):
        if tag in self.inside:
            del self.inside[len(self.inside) - 1 - self.inside[::-1].index(tag):]

    def handle_data(self, data):
        if not self.inside:
            self.text.append(data)


def themes():
    try:
        from mkdocs.utils import get_theme_names  # which knows where Debian has them
    except ImportError:
        return []
    return list(get_theme_names())


def build(site):
    command = ["mkdocs", "build", "--strict", "--clean", "--config-file", str(ROOT / "scripts/site/mkdocs.yml"), "--site-dir", str(site)]
    alone = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
    if subprocess.run([*alone, "true"], capture_output=True, check=False).returncode == 0:
        command = alone + command
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"})
    return [f"mkdocs ended with {done.returncode}: {done.stderr}"] if done.returncode else []


def look(site):
    pages = {path.resolve(): Page(path) for path in site.rglob("*.html")}
    for path, page in pages.items():
        where = path.relative_to(site.resolve())
        for target in [*page.links, *page.loads]:
            if re.match(r"\w+:", target) or target.startswith("//"):
                if target in page.loads:
                    yield f"{where}: loads {target} from elsewhere"
                continue
            file, _, anchor = target.partition("#")
            there = (path.parent / file).resolve() if file else path
            if where.name == "404.html":  # its links are those of a server
                continue
            if not (there / "index.html").exists() and not there.is_file():
                yield f"{where}: {target} is not there"
            elif anchor and there in pages and anchor not in pages[there].ids:
                yield f"{where}: {target}: no such heading"
        text = "".join(page.text)
        for broken, what in ((r"```", "code"), (r"\|\s*-{3,}\s*\|", "a table"), (r"(?m)^(- |\d+\. )\S", "a list")):
            for found in re.finditer(broken, text):
                yield f"{where}: {what} is shown as text: {text[max(0, found.start() - 30):found.end() + 40]!r}"
    for path in site.rglob("*.css"):
        for found in re.findall(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\"')]+)", path.read_text(encoding="utf-8")):
            yield f"{path.relative_to(site)}: loads {found} from elsewhere"
    sources = [path for path in (ROOT / "docs").rglob("*.md")]
    if len(sources) + 1 != len(pages):
        yield f"{len(sources)} pages in docs, {len(pages)} here with the one for what is not there"


def main():
    if "material" not in themes():
        print("mkdocs or mkdocs-material is not installed (scripts/setup tests): not shown here")
        sys.exit(77)
    site = pathlib.Path(sys.argv[1])
    problems = build(site) or list(look(site))
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{len(list(site.rglob('*.html')))} pages, {len(problems)} problems")
    sys.exit(bool(problems))


if __name__ == "__main__":
    main()
