"""A server that speaks as language models do, by a script for each name of a model."""

import base64
import io
import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from PIL import Image


class Turn:
    """What a script knows of a request: its body, how far the talk is and what came before."""

    def __init__(self, body, anthropic, hits):
        self.body, self.anthropic, self.hits = body, anthropic, hits
        self.messages = body["messages"]
        self.answers = sum(message["role"] == "assistant" for message in self.messages)
        self.text = json.dumps(self.messages)

    @property
    def tools(self):
        found = self.body.get("tools", [])
        return [tool["name"] if self.anthropic else tool["function"]["name"] for tool in found]

    @property
    def image_size(self):
        """The size of the picture that came, which proves that it did."""
        for message in self.messages:
            parts = message["content"] if isinstance(message["content"], list) else []
            for part in parts:
                if part["type"] == "image_url":
                    data = part["image_url"]["url"].partition("base64,")[2]
                elif part["type"] == "image":
                    data = part["source"]["data"]
                else:
                    continue
                return list(Image.open(io.BytesIO(base64.b64decode(data))).size)
        return None


def call(name, args):
    return {"call": name, "args": args if isinstance(args, str) else json.dumps(args)}


def text(value):
    return {"text": value if isinstance(value, str) else json.dumps(value)}


def failure(status, message="no", **headers):
    return {"status": status, "body": {"error": {"message": message}}, "headers": headers}


class ScriptedServer:
    """Scripts: name of a model to a function of a `Turn` that returns its reply."""

    def __init__(self):
        self.scripts, self.turns, self.headers = {}, [], []
        outer = self

        class Handler(BaseHTTPRequestHandler):
            def do_POST(self):
                body = json.loads(self.rfile.read(int(self.headers["content-length"])))
                outer.headers.append({k.lower(): v for k, v in self.headers.items()})
                hits = sum(turn.body["model"] == body["model"] for turn in outer.turns)
                turn = Turn(body, self.path.endswith("/messages"), hits)
                outer.turns.append(turn)
                reply = outer.scripts[body["model"]](turn)
                wire = _anthropic if turn.anthropic else _chat
                payload = reply.get("body") or wire(body["model"], reply)
                data = (
                    payload.encode() if isinstance(payload, str) else json.dumps(payload).encode()
                )
                self.send_response(reply.get("status", 200))
                for name, value in reply.get("headers", {}).items():
                    self.send_header(name.replace("_", "-"), value)
                self.send_header("content-type", "application/json")
                self.send_header("content-length", str(len(data)))
                self.end_headers()
                self.wfile.write(data)

            def log_message(self, *_):
                pass

        self._http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._http.handle_error = lambda *_: None  # a client that no longer waits
        self.root = f"http://127.0.0.1:{self._http.server_port}"
        self.url = f"{self.root}/v1"
        threading.Thread(target=self._http.serve_forever, args=(0.02,), daemon=True).start()

    def close(self):
        self._http.shutdown()
        self._http.server_close()


def _chat(model, reply):
    message = {"role": "assistant", "content": reply.get("text")}
    if "call" in reply:
        function = {"name": reply["call"], "arguments": reply["args"]}
        message["tool_calls"] = [{"id": "call_1", "type": "function", "function": function}]
    return {
        "id": "1", "object": "chat.completion", "created": 1, "model": model,
        "choices": [{"index": 0, "message": message,
                     "finish_reason": "tool_calls" if "call" in reply else "stop"}],
        "usage": reply.get("usage", {"prompt_tokens": 100, "completion_tokens": 20,
                                     "total_tokens": 120}),
    }  # fmt: skip


def _anthropic(model, reply):
    content = [{"type": "text", "text": reply["text"]}] if "text" in reply else [
        {"type": "tool_use", "id": "toolu_1", "name": reply["call"],
         "input": json.loads(reply["args"])}
    ]  # fmt: skip
    return {
        "id": "1", "type": "message", "role": "assistant", "model": model, "content": content,
        "stop_reason": "tool_use" if "call" in reply else "end_turn", "stop_sequence": None,
        "usage": {"input_tokens": 100, "output_tokens": 20},
    }  # fmt: skip
