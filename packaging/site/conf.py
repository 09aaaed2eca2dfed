# SPDX-License-Identifier: Apache-2.0
"""Sphinx over the pages that tools/site lays out (which says where); called by it alone."""
import os
import re

from pygments.lexers.special import TextLexer

project = "Handpiece"
author = "The Handpiece authors"
copyright = author
version = release = os.environ["SITE_VERSION"]
language = "en"
extensions = ["myst_parser"]
if os.environ.get("SITE_PYTHON"):
    import sys

    sys.path.insert(0, os.environ["SITE_PYTHON"])
    extensions += ["sphinx.ext.autodoc", "sphinx.ext.napoleon"]
    autodoc_member_order = "groupwise"
    autodoc_typehints = "signature"
    napoleon_use_ivar = True
root_doc = "index"
source_suffix = {".md": "markdown"}
# Headings have the names that a forge gives them, so that a link is good here and there.
myst_heading_anchors = 6
# A page of ours may begin below its title; what a forge takes is good.
suppress_warnings = ["myst.header"]

html_theme = "furo"
html_title = "Handpiece " + version
html_static_path = ["_own"]
html_css_files = ["style.css"]
html_extra_path = ["_extra"]
html_favicon = "_own/icon.svg"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b6b70", "color-brand-content": "#0b6b70"},
    "dark_css_variables": {"color-brand-primary": "#6cc5c9", "color-brand-content": "#6cc5c9"},
    "top_of_page_button": None,
}
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False
# What stands beside a find would be fetched page by page, which a browser refuses to pages from the disk.
html_show_search_summary = False
html_use_index = False
html_domain_indices = False
pygments_style = "friendly"
pygments_dark_style = "native"


def tell_language(_app, page, _template, context, _tree):
    if page.endswith(".ja"):
        context["language"] = "ja"


def as_imported(_app, _what, _name, _thing, _options, signature, returns):
    """Names as one imports them, and no type of one's self."""
    def short(text):
        return text and re.sub(r"\bself: [\w.]+", "self", text).replace("handpiece._core.", "handpiece.")

    return short(signature), short(returns)


def setup(app):
    if "sphinx.ext.autodoc" in extensions:
        app.connect("autodoc-process-signature", as_imported)
    app.connect("html-page-context", tell_language)
    for fence in ("synopsis", "csv"):
        app.add_lexer(fence, TextLexer)
