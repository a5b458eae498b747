import { type Message, unpacked } from "./messages";

type Answer = Record<string, unknown> & { id: number; error?: string };
export type Heard = (message: Message) => void;

interface Waiting {
  resolve: (message: Message) => void;
  heard?: Heard;
}

/** The server: questions with answers, and what comes in between; it is looked for again when it has gone. */
export class Connection {
  private socket?: WebSocket;
  private number = Date.now(); // above all numbers from before a reload
  private waiting = new Map<number, Waiting>();
  private delay = 250;

  constructor(
    private address: string,
    private told: (connected: boolean) => void,
  ) {
    this.connect();
  }

  private connect(): void {
    const socket = new WebSocket(this.address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.socket = socket;
      this.delay = 250;
      this.told(true);
    };
    socket.onmessage = (event) => this.hear(event.data);
    socket.onclose = () => {
      const open = this.socket === socket;
      this.socket = undefined;
      for (const waiting of this.waiting.values())
        waiting.resolve({ head: { id: 0, error: "no connection to the server" }, arrays: {} });
      this.waiting.clear();
      if (open) this.told(false);
      setTimeout(() => this.connect(), this.delay);
      this.delay = Math.min(2 * this.delay, 4000);
    };
  }

  private hear(data: string | ArrayBuffer): void {
    const message = typeof data === "string" ? { head: JSON.parse(data) as Answer, arrays: {} } : unpacked(data);
    const waiting = this.waiting.get(message.head.id as number);
    const event = message.head.event;
    if (event && event !== "ended") waiting?.heard?.(message);
    else {
      this.waiting.delete(message.head.id as number);
      waiting?.resolve(message);
    }
  }

  /** Ask something; `heard` takes what comes before the answer. `id`: of a question that is under way already. */
  ask(what: string, given: object = {}, heard?: Heard, id = ++this.number): Promise<Message> {
    if (!this.socket) return Promise.resolve({ head: { id, error: "no connection to the server" }, arrays: {} });
    return new Promise((resolve) => {
      this.waiting.set(id, { resolve, heard });
      this.socket?.send(JSON.stringify({ id, do: what, ...given }));
    });
  }

  /** Say something that has no answer. */
  tell(what: string): void {
    this.socket?.send(JSON.stringify({ id: ++this.number, do: what }));
  }
}

/** Asks for the latest that is wanted only: one question is on its way, and one waits. */
export class Latest<Wanted> {
  private busy = false;
  private next?: Wanted;

  constructor(private act: (wanted: Wanted) => Promise<void>) {}

  async want(wanted: Wanted): Promise<void> {
    this.next = wanted;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.next !== undefined) {
        const now = this.next;
        this.next = undefined;
        await this.act(now);
      }
    } finally {
      this.busy = false;
    }
  }
}
