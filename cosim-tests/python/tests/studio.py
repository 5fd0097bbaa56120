"""Foxglove Studio, or a viewer made from it, in a headless browser: opens a log as a user does.

    python studio.py FOLDER LOG PICTURE

FOLDER holds the viewer's web page. Opens LOG, imports the kit's layout, goes to the end, writes
PICTURE (PNG) and prints what the viewer says of the log's topics.
"""

import functools
import shutil
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from playwright.sync_api import Locator, Page, sync_playwright

LAYOUT = Path(__file__).parents[2] / "foxglove-layout.json"
# WebGL without a graphics card.
RENDERER = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"]
# The viewer is 56 MB of script, which a busy machine takes a while to read.
PATIENCE_MS = 120_000
# A page can be given a file by a test through an input element only; what the viewers ask for is
# a handle that they can keep, which the page's own storage has.
FILE_PICKER = """
window.showOpenFilePicker = async () => {
  const input = Object.assign(document.createElement("input"), { type: "file" });
  const chosen = new Promise((resolve) => { input.onchange = () => resolve(input.files[0]); });
  input.click();
  const file = await chosen;
  const folder = await navigator.storage.getDirectory();
  const handle = await folder.getFileHandle(file.name, { create: true });
  await file.stream().pipeTo(await handle.createWritable());
  return [handle];
};
"""


class Studio:
    """One open viewer. `errors` collects what its console reports as errors."""

    def __init__(self, page: Page):
        self.page = page
        self.errors: list[str] = []
        page.on("console", lambda line: line.type == "error" and self.errors.append(line.text))
        page.on("pageerror", lambda error: self.errors.append(str(error)))

    def open_log(self, log: Path):
        """By "Open local file"; back when the log's last time is known."""
        self._choose(self.page.get_by_text("Open local file"), log)
        self.page.get_by_test_id("PlaybackTime-text").wait_for()

    def topics(self) -> str:
        """Names, types and message counts, as the viewer lists them."""
        self._text("Topics").click()
        self.page.get_by_text("/telemetry", exact=True).wait_for()
        return self.page.inner_text("body")

    def problems(self) -> str:
        """What the viewer has to say against the log."""
        self.page.get_by_role("tab").filter(has_text="Problems").click()
        return self.page.inner_text("body")

    def import_layout(self, layout: Path):
        self.page.get_by_title("Layouts").or_(self._text("Layouts")).first.click()
        button = self.page.get_by_title("Import layout").or_(self._text("Import from file…")).first
        self._choose(button, layout)
        self.page.get_by_text(layout.stem, exact=True).wait_for()

    def panel(self, title: str) -> Locator:
        """The panel under this title."""
        panels = self.page.locator("[data-testid^=panel-mouseenter-container]")
        return panels.filter(has_text=title)

    def go_to(self, share: float):
        """To a share of the flight, by a click on the slider above the play button."""
        play = self.page.get_by_title("Play", exact=True).bounding_box()
        margin = 10
        width = self.page.viewport_size["width"] - 2 * margin
        self.page.mouse.click(margin + share * width, play["y"] - 0.5 * play["height"])
        # Away again, or what the pointer shows covers a panel.
        self.page.mouse.move(0.5 * width, play["y"])

    def _text(self, text: str) -> Locator:
        return self.page.get_by_text(text, exact=True)

    def _choose(self, button: Locator, file: Path):
        with self.page.expect_file_chooser() as chooser:
            button.first.click()
        chooser.value.set_files(file)


@contextmanager
def studio(folder: Path) -> Iterator[Studio]:
    """A viewer whose page is in `folder`, served to a browser without a window."""
    handler = functools.partial(Quiet, directory=folder)
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        with sync_playwright() as playwright:
            chromium = shutil.which("chromium")
            browser = playwright.chromium.launch(executable_path=chromium, args=RENDERER)
            page = browser.new_page(viewport={"width": 1600, "height": 900})
            page.set_default_timeout(PATIENCE_MS)
            page.add_init_script(FILE_PICKER)
            viewer = Studio(page)
            page.goto(f"http://127.0.0.1:{server.server_port}/index.html")
            yield viewer
            browser.close()
        server.shutdown()


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


if __name__ == "__main__":
    folder, log, picture = (Path(argument) for argument in sys.argv[1:])
    with studio(folder) as viewer:
        viewer.open_log(log)
        print(viewer.topics())
        viewer.import_layout(LAYOUT)
        viewer.go_to(1.0)
        # Curves are read and drawn beside the page; nothing on it says that they are complete.
        viewer.page.wait_for_timeout(20_000)
        viewer.page.screenshot(path=picture)
        print(*viewer.errors, sep="\n", file=sys.stderr)
