# SPDX-License-Identifier: MIT
"""Drops files on a window as a file manager does (XDND version 5), and reads the clipboard, spoken
through libX11."""
import ctypes
import ctypes.util
import time
import urllib.parse

from cli import Failed, skip

CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY = 33, 30, 31
PROP_MODE_REPLACE, CURRENT_TIME = 0, 0


class ClientMessage(ctypes.Structure):
    _fields_ = [('type', ctypes.c_int), ('serial', ctypes.c_ulong), ('send_event', ctypes.c_int),
                ('display', ctypes.c_void_p), ('window', ctypes.c_ulong),
                ('message_type', ctypes.c_ulong), ('format', ctypes.c_int),
                ('data', ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [('type', ctypes.c_int), ('serial', ctypes.c_ulong), ('send_event', ctypes.c_int),
                ('display', ctypes.c_void_p), ('owner', ctypes.c_ulong),
                ('requestor', ctypes.c_ulong), ('selection', ctypes.c_ulong),
                ('target', ctypes.c_ulong), ('property', ctypes.c_ulong), ('time', ctypes.c_ulong)]


class SelectionNotify(ctypes.Structure):
    _fields_ = [('type', ctypes.c_int), ('serial', ctypes.c_ulong), ('send_event', ctypes.c_int),
                ('display', ctypes.c_void_p), ('requestor', ctypes.c_ulong),
                ('selection', ctypes.c_ulong), ('target', ctypes.c_ulong),
                ('property', ctypes.c_ulong), ('time', ctypes.c_ulong)]


class Event(ctypes.Union):
    _fields_ = [('type', ctypes.c_int), ('client', ClientMessage), ('request', SelectionRequest),
                ('notify', SelectionNotify), ('pad', ctypes.c_long * 24)]


class Source:
    """The side that is dragged from."""

    def __init__(self, viewer):
        path = ctypes.util.find_library('X11')
        if not path:
            skip('libX11 is not installed')
        self.x = x = ctypes.CDLL(path)
        x.XOpenDisplay.restype = ctypes.c_void_p
        x.XInternAtom.restype = x.XDefaultRootWindow.restype = ctypes.c_ulong
        x.XCreateSimpleWindow.restype = ctypes.c_ulong
        self.display = ctypes.c_void_p(x.XOpenDisplay(viewer.display.name.encode()))
        root = ctypes.c_ulong(x.XDefaultRootWindow(self.display))
        self.root = root
        self.window = x.XCreateSimpleWindow(self.display, root, 0, 0, 1, 1, 0,
                                            ctypes.c_ulong(0), ctypes.c_ulong(0))
        self.target = int(viewer.window)
        self.uri_list = self.atom('text/uri-list')

    def atom(self, name):
        return self.x.XInternAtom(self.display, name.encode(), 0)

    def send(self, name, *data):
        event = Event()
        event.client.type = CLIENT_MESSAGE
        event.client.window = self.target
        event.client.message_type = self.atom(name)
        event.client.format = 32
        event.client.data = (ctypes.c_long * 5)(self.window, *data, *[0] * (4 - len(data)))
        self.post(self.target, event)

    def post(self, window, event):
        self.x.XSendEvent(self.display, ctypes.c_ulong(window), 0, ctypes.c_long(0),
                          ctypes.byref(event))
        self.x.XFlush(self.display)

    def answer(self, request, data):
        self.x.XChangeProperty(self.display, ctypes.c_ulong(request.requestor),
                               ctypes.c_ulong(request.property), ctypes.c_ulong(request.target), 8,
                               PROP_MODE_REPLACE, data, len(data))
        event = Event()
        event.notify.type = SELECTION_NOTIFY
        event.notify.requestor = request.requestor
        event.notify.selection = request.selection
        event.notify.target = request.target
        event.notify.property = request.property
        self.post(request.requestor, event)

    def serve(self, data, seconds=20):
        """Answers until the target says that it is done."""
        end = time.monotonic() + seconds
        finished = self.atom('XdndFinished')
        status = self.atom('XdndStatus')
        dropped = False
        event = Event()
        while time.monotonic() < end:
            if not self.x.XPending(self.display):
                time.sleep(0.02)
                continue
            self.x.XNextEvent(self.display, ctypes.byref(event))
            if event.type == SELECTION_REQUEST:
                self.answer(event.request, data)
            elif event.type == CLIENT_MESSAGE and event.client.message_type == finished:
                return
            elif event.type == CLIENT_MESSAGE and event.client.message_type == status:
                if not dropped:
                    self.send('XdndDrop', 0, CURRENT_TIME)
                dropped = True
        raise Failed('the window took no drop')


def drop_files(viewer, *paths):
    source = Source(viewer)
    data = ''.join(f'file://{urllib.parse.quote(p)}\r\n' for p in paths).encode()
    source.x.XSetSelectionOwner(source.display, ctypes.c_ulong(source.atom('XdndSelection')),
                                ctypes.c_ulong(source.window), ctypes.c_ulong(CURRENT_TIME))
    source.send('XdndEnter', 5 << 24, source.uri_list)
    source.send('XdndPosition', 0, 20 << 16 | 20, CURRENT_TIME, source.atom('XdndActionCopy'))
    try:
        source.serve(data)
    finally:
        source.x.XCloseDisplay(source.display)


def clipboard(viewer, seconds=20):
    """The text that the viewer has put there."""
    source = Source(viewer)
    x, kind = source.x, source.atom('UTF8_STRING')
    x.XConvertSelection(source.display, ctypes.c_ulong(source.atom('CLIPBOARD')),
                        ctypes.c_ulong(kind), ctypes.c_ulong(kind), ctypes.c_ulong(source.window),
                        ctypes.c_ulong(CURRENT_TIME))
    x.XFlush(source.display)
    event, end = Event(), time.monotonic() + seconds
    while event.type != SELECTION_NOTIFY:
        if time.monotonic() > end:
            raise Failed('nobody answers for the clipboard')
        if x.XPending(source.display):
            x.XNextEvent(source.display, ctypes.byref(event))
        else:
            time.sleep(0.02)
    text, of_type, form = ctypes.c_char_p(), ctypes.c_ulong(), ctypes.c_int()
    count, left = ctypes.c_ulong(), ctypes.c_ulong()
    x.XGetWindowProperty(source.display, ctypes.c_ulong(source.window), ctypes.c_ulong(kind),
                         ctypes.c_long(0), ctypes.c_long(4096), 1, ctypes.c_ulong(0),
                         ctypes.byref(of_type), ctypes.byref(form), ctypes.byref(count),
                         ctypes.byref(left), ctypes.byref(text))
    x.XCloseDisplay(source.display)
    return (text.value or b'').decode()
