"""Serves the page of a folder while a test runs."""

import threading
import time
from contextlib import contextmanager

from cityx.protocol.registry import registry
from cityx.server.owner import Owner

TOKEN = "a-token-of-this-test"


@contextmanager
def serving(folder, port=0, token=TOKEN, **more):
    """Serve the page of a folder in a thread; gives the port, 0 for any that is free."""
    import uvicorn

    from cityx.server.serve import listening
    from cityx.viewer.serving import CityPage

    with Owner(folder, registry()) as owner, listening(port) as listener:
        port = listener.getsockname()[1]
        page = CityPage(owner, port, token, **more)
        config = uvicorn.Config(page.app(), log_level="warning", timeout_graceful_shutdown=1)
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        while not server.started:
            time.sleep(0.01)
        yield port
        page.end()
        server.should_exit = True
        thread.join(10)
