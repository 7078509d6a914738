"""One executed notebook as one self-contained HTML page: findings first, code behind a toggle, nothing loaded."""
import os
import re
from html import escape

import jinja2
from nbconvert.filters import markdown2html
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

HERE = os.path.dirname(os.path.realpath(__file__))
_FORMATTER = HtmlFormatter(nowrap=True, style="friendly")


def _output_html(output, alternative):
    """One output of a cell: a figure, our own HTML (the cells escape what comes from data), or plain text."""
    if output.output_type == "stream":
        return f"<pre>{escape(output.text)}</pre>"
    data = output.get("data", {})
    if "image/png" in data:
        size = output.metadata.get("image/png", {})
        width = f' width="{size["width"]}"' if "width" in size else ""
        source = f"data:image/png;base64,{data['image/png'].strip()}"
        return f'<figure><img alt="{escape(alternative)}"{width} src="{source}"></figure>'
    if "text/html" in data:
        return f'<div class="output">{data["text/html"]}</div>'
    return f"<pre>{escape(data.get('text/plain', ''))}</pre>"


def render(notebook, notebook_name, home=""):
    """The page as text.

    notebook_name: file name of the notebook beside the page; home: file name of the overview, if there is one.
    """
    parts, sections, code, heading = [], [], [], ""
    title = notebook.metadata["title"]
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            html = markdown2html(cell.source)
            match = re.search(r'<h2 id="([^"]*)">(.*?)<a class="anchor-link"', html)
            if match:
                heading = re.sub(r"<[^>]*>", "", match[2])
                sections.append({"anchor": match[1], "name": heading})
            parts.append({"html": re.sub(r'<a class="anchor-link".*?</a>', "", html)})
            continue
        code.append(cell.source)  # cells without output are shown together with the next that has one
        if cell.outputs:
            parts.append({"html": "".join(_output_html(output, heading or title) for output in cell.outputs),
                          "code": highlight("\n\n\n".join(code), PythonLexer(), _FORMATTER)})
            code = []
    template = jinja2.Environment(loader=jinja2.FileSystemLoader(HERE), autoescape=True, trim_blocks=True,
                                  lstrip_blocks=True, undefined=jinja2.StrictUndefined).get_template("page.html.j2")
    return template.render(title=title, parts=parts, sections=sections, notebook_name=notebook_name, home=home,
                           code_style=_FORMATTER.get_style_defs(".code pre"))
