"""A wireless-like link as a TCP proxy on 127.0.0.1: one medium that both directions take turns on, as 802.11 does."""
import queue
import socket
import threading
import time

PACKET_BYTES, WINDOW_BYTES = 1460, 262144


class ShapedLink:
    """`bits_per_second`, shared by all connections; `delay`: seconds one way. `port`: where to connect."""

    def __init__(self, target_port, bits_per_second, delay):
        self.target_port, self.rate, self.delay = target_port, bits_per_second, delay
        self.lock, self.free, self.byte_count = threading.Lock(), 0.0, 0
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client = self.listener.accept()[0]
            except OSError:
                return
            try:
                server = socket.create_connection(("127.0.0.1", self.target_port))
            except OSError:  # the server is down
                client.close()
                continue
            for end in (client, server):
                end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self.pump, args=(client, server), daemon=True).start()
            threading.Thread(target=self.pump, args=(server, client), daemon=True).start()

    def pump(self, source, sink):
        packets, window = queue.Queue(), threading.BoundedSemaphore(WINDOW_BYTES // PACKET_BYTES)
        threading.Thread(target=self.deliver, args=(packets, window, sink), daemon=True).start()
        while True:
            window.acquire()
            try:
                data = source.recv(PACKET_BYTES)
            except OSError:
                data = b""
            due = 0.0
            if data:
                with self.lock:
                    self.byte_count += len(data)
                    self.free = max(time.monotonic(), self.free) + 8 * len(data) / self.rate
                    due = self.free + self.delay
            packets.put((due, data))
            if not data:
                return

    def deliver(self, packets, window, sink):
        while True:
            due, data = packets.get()
            if not data:
                break
            time.sleep(max(0.0, due - time.monotonic()))
            try:
                sink.sendall(data)
            except OSError:
                pass
            window.release()
        try:
            sink.shutdown(socket.SHUT_WR)
        except OSError:
            pass

    def close(self):
        self.listener.close()
