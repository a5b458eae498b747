import { type Message, unpacked } from "./messages";

export type Heard = (message: Message) => void;

const GONE: Message = { head: { error: "no connection to the server" }, arrays: {} };

interface Waiting {
  resolve: (message: Message) => void;
  heard?: Heard;
}

/** What is wrong with what was asked, or the first mistake in its scenario; empty if nothing is. */
export function wrongOf({ problems, error }: Message["head"]): string {
  return String((problems as { message: string }[] | undefined)?.[0]?.message ?? error ?? "");
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
      for (const waiting of this.waiting.values()) waiting.resolve(GONE);
      this.waiting.clear();
      if (open) this.told(false);
      setTimeout(() => this.connect(), this.delay);
      this.delay = Math.min(2 * this.delay, 4000);
    };
  }

  private hear(data: string | ArrayBuffer): void {
    const message: Message = typeof data === "string" ? { head: JSON.parse(data), arrays: {} } : unpacked(data);
    const { id, event } = message.head as { id: number; event?: string };
    const waiting = this.waiting.get(id);
    if (event && event !== "ended") return waiting?.heard?.(message);
    this.waiting.delete(id);
    waiting?.resolve(message);
  }

  /** Ask something; `heard` takes what comes before the answer. `id`: of a question that is under way already. */
  ask(what: string, given: object = {}, heard?: Heard, id = ++this.number): Promise<Message> {
    if (!this.socket) return Promise.resolve(GONE);
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
