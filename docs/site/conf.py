"""Sphinx's part of the site; docs/site/pages.py makes what it reads. Nothing may come from the network."""

import gc
import os

# A site of this size stays in memory until it is written: to look for garbage in it takes a third of the time.
gc.disable()

project = "mbk"
author = "the authors of mbk"
project_copyright = "the authors of mbk, BSD 3-Clause"
version = release = os.environ["MBK_VERSION"]

extensions = ["myst_parser"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # the documents go from # to ### where that reads better
exclude_patterns = []

html_theme = "furo"
html_title = f"mbk {release}"
html_static_path = [os.environ["MBK_SITE_STATIC"]]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_search_scorer = os.path.join(os.path.dirname(os.path.abspath(__file__)), "search_order.js")
templates_path = ["templates"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "light_css_variables": {
        "color-brand-primary": "#0f5c8c",
        "color-brand-content": "#0f5c8c",
        "font-stack": "system-ui, 'Segoe UI', 'DejaVu Sans', 'Noto Sans', sans-serif",
        "font-stack--monospace": "ui-monospace, 'DejaVu Sans Mono', 'Noto Sans Mono', monospace",
    },
    "dark_css_variables": {"color-brand-primary": "#7cc4ee", "color-brand-content": "#7cc4ee"},
    "footer_icons": [],
}
pygments_style = "default"
pygments_dark_style = "github-dark"
highlight_language = "text"
