"""What mkdocs asks while it builds: contents as docs/README.md has them, headings named as in plain Markdown viewers, and the examples that pages link to."""
import logging
import pathlib
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
log = logging.getLogger("mkdocs.fissure")


def contents():
    """Sections of docs/README.md: a line that ends with a colon, then links to pages."""
    nav = [{"Documentation": "README.md"}]
    for line in (ROOT / "docs/README.md").read_text(encoding="utf-8").splitlines():
        link = re.match(r"- \[(.*?)\]\((\S+?\.md)\)", line)
        if re.match(r"\w.*:$", line):
            nav.append({line[:-1]: []})
        elif link:
            next(iter(nav[-1].values())).append({link[1]: link[2]})
    return nav


def on_config(config):
    config["nav"] = contents()
    config["mdx_configs"]["toc"]["slugify"] = lambda title, _: re.sub(r"[^\w\- ]", "", title.lower()).strip().replace(" ", "-")
    return config


def on_files(files, config):
    listed = {page for section in config["nav"] for pages in section.values() if isinstance(pages, list) for one in pages for page in one.values()}
    for file in files.documentation_pages():
        if file.src_path not in listed | {"README.md"}:
            log.warning("docs/README.md does not list %s", file.src_path)
    for path in EXAMPLES.rglob("*.lua"):
        files.append(File(str(path.relative_to(ROOT)), str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def on_page_markdown(markdown, **_):
    markdown = re.sub(r"(?m)^```lua scene$", "```lua", markdown)    # check_docs.py knows by it what to try
    return re.sub(r"\]\(\.\./((?:\.\./)*examples/)", r"](\1", markdown)  # one folder up in the sources, beside the pages here
