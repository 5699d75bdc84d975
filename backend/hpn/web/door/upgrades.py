"""Offers of another protocol, which the service leaves alone: it answers in HTTP/1.1 (RFC 9110, 7.8)."""

from httptools import HttpParserError, HttpParserUpgrade
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol


class Protocol(HttpToolsProtocol):
    """uvicorn's HTTP/1.1, in which a request that offers another protocol keeps its body.

    Java's HTTP client offers h2c with its first request. The parser ends such a request behind its head and takes the
    body for the next one, so that it gets the head once more, without the offer.
    """

    head = b""

    def on_headers_complete(self) -> None:
        """Start the request, unless its head comes again."""
        offers = self.parser.should_upgrade() and self.parser.get_method() != b"CONNECT"
        self.head = self._head_without_offer() if offers else b""
        if not self.head:
            super().on_headers_complete()

    def on_message_complete(self) -> None:
        """End the request, unless its head comes again."""
        if not self.head:
            super().on_message_complete()

    def data_received(self, data: bytes) -> None:
        """Parse what has arrived."""
        self._unset_keepalive_if_required()
        rest = memoryview(data)
        try:
            while (end := self._offered_at(rest)) is not None:
                self.parser.feed_data(self.head)
                rest = rest[end:]
        except HttpParserError:
            self.logger.warning("Invalid HTTP request received.")
            self.send_400_response("Invalid HTTP request received.")

    def _offered_at(self, data: memoryview) -> int | None:
        """End of a head with an offer, up to which the data are parsed; None where all of them are."""
        try:
            self.parser.feed_data(data)
        except HttpParserUpgrade as offer:
            return int(offer.args[0])
        return None

    def _head_without_offer(self) -> bytes:
        start = b"%b %b HTTP/%b" % (self.parser.get_method(), self.url, self.parser.get_http_version().encode())
        fields = [b"%b: %b" % field for field in self.headers if field[0] != b"upgrade"]
        return b"\r\n".join([start, *fields, b"", b""])
