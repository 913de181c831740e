"""What mkdocs reads differently from a code-hosting site: names of headings, lists, pipes in tables, comments."""

import html
import re

from markdown.extensions import toc

FENCE = re.compile(r"^\s*(`{3,}|~{3,})")
ITEM = re.compile(r"(?:[-*+]|\d+[.)]) +")


def slug(title, _separator):
    """The name of a heading as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", html.unescape(title).strip().lower()).replace(" ", "-")


def unique(name, taken):
    """GitHub numbers equal names with a dash."""
    count, free = 0, name
    while free in taken:
        count += 1
        free = f"{name}-{count}"
    taken.add(free)
    return free


def on_config(config):
    toc.unique = unique
    config["mdx_configs"]["toc"] = {"slugify": slug, "permalink": False}
    return config


def without_comments(text):
    """Comments outside fenced blocks removed: they are the commands of tools/make-docs."""
    kept, fence = [], None
    parts = re.split(r"(^[ \t]*(?:`{3,}|~{3,})[^\n]*$|<!--.*?-->)", text, flags=re.M | re.S)
    for part in parts:
        mark = FENCE.match(part)
        if mark and not part.startswith("<!--"):
            fence = None if fence else mark.group(1)
        if fence is None and part.startswith("<!--"):
            part = ""
        kept.append(part)
    return "".join(kept)


def on_page_markdown(markdown, **_):
    """Text that belongs to an item of a list is indented by four, and a pipe within code in a table is not escaped."""
    lines, fence, width = [], None, 0
    for line in without_comments(markdown).split("\n"):
        indent = len(line) - len(line.lstrip(" "))
        item = ITEM.match(line)
        if fence is None and item:
            width = len(item.group(0))
        elif width and line.strip() and indent >= width:
            line = "    " + line[width:]
        elif width and line.strip() and lines and not lines[-1].strip():
            width = 0
        mark = FENCE.match(line)
        if mark and (fence is None or mark.group(1).startswith(fence)):
            fence = None if fence else mark.group(1)
        elif fence is None and line.startswith("|"):
            line = re.sub(r"`[^`]*`", lambda span: span.group(0).replace("\\|", "|"), line)
        lines.append(line)
    return "\n".join(lines)
