//! A lab of its own for a test, and what a client says to it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

use serde_json::Value;

/// A lab that is served, until it goes out of scope.
pub struct Lab {
    child: Child,
    /// Where it puts scenes that are dropped on it.
    pub places: tempfile::TempDir,
    /// `127.0.0.1:PORT`.
    pub host: String,
}

/// What was answered.
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Lab {
    pub fn start(flags: &str) -> Lab {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
        let places = tempfile::tempdir().unwrap();
        let command = command.args(["lab", "--port", "0"]).args(flags.split_whitespace()).env("TMPDIR", places.path());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let host =
            line.split("http://").nth(1).unwrap_or_else(|| panic!("{line}")).split('/').next().unwrap().to_owned();
        Lab { child, places, host }
    }

    pub fn pid(&self) -> u32 {
        self.child.id()
    }

    pub fn url(&self, address: &str) -> String {
        format!("http://{}/{address}", self.host)
    }

    /// Asks for something, and hears all of the answer.
    pub fn get(&self, path: &str) -> Answer {
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: {}\r\n", self.host), "")
    }

    pub fn post(&self, path: &str, json: &Value) -> Answer {
        let head = format!("POST {path} HTTP/1.1\r\nHost: {}\r\nContent-Type: application/json\r\n", self.host);
        self.ask(&head, &json.to_string())
    }

    /// The same with a head of one's own, each line of which has its end.
    pub fn ask(&self, head: &str, body: &str) -> Answer {
        let mut stream = self.send(head, body);
        let mut bytes = Vec::new();
        // A lab that refuses a long body may close before it has taken all of it.
        let _ = stream.read_to_end(&mut bytes);
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).unwrap_or_else(|| panic!("{text}"));
        let is_chunked = head.to_lowercase().contains("transfer-encoding: chunked");
        let body = if is_chunked { unchunked(body.as_bytes()) } else { body.to_owned() };
        Answer { status, head: head.to_owned(), body }
    }

    /// Asks, and leaves the answer to be heard.
    pub fn send(&self, head: &str, body: &str) -> TcpStream {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let request = format!("{head}Content-Length: {}\r\nConnection: close\r\n\r\n{body}", body.len());
        let _ = stream.write_all(request.as_bytes());
        stream
    }

    /// Ends it as Ctrl-C does, and tells how it ended.
    pub fn interrupt(&mut self) -> Option<i32> {
        Command::new("kill").args(["-INT", &self.pid().to_string()]).status().unwrap();
        self.child.wait().unwrap().code()
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        if let Ok(None) = self.child.try_wait() {
            let _ = Command::new("kill").args(["-INT", &self.pid().to_string()]).status();
            let _ = self.child.wait();
        }
    }
}

impl Answer {
    /// The events of a stream: names and data.
    pub fn events(&self) -> Vec<(String, String)> {
        assert_eq!(self.status, 200, "{}", self.body);
        let blocks = self.body.split("\n\n").filter(|block| !block.trim().is_empty());
        let field = |block: &str, name: &str| {
            let lines = block.lines().filter_map(|line| line.strip_prefix(name)?.strip_prefix(": "));
            lines.collect::<Vec<_>>().join("\n")
        };
        blocks.map(|block| (field(block, "event"), field(block, "data"))).collect()
    }

    /// What the first event of a name says.
    #[track_caller]
    pub fn event(&self, name: &str) -> String {
        let found = self.events().into_iter().find(|event| event.0 == name);
        found.unwrap_or_else(|| panic!("no {name}: {:?}", self.events().last())).1
    }

    /// What is told of a run that is done.
    #[track_caller]
    pub fn done(&self) -> Value {
        serde_json::from_str(&self.event("done")).unwrap()
    }
}

/// A body that came in chunks.
fn unchunked(mut rest: &[u8]) -> String {
    let mut whole = Vec::new();
    while let Some(end) = rest.windows(2).position(|pair| pair == b"\r\n") {
        let size = usize::from_str_radix(std::str::from_utf8(&rest[..end]).unwrap(), 16).unwrap();
        if size == 0 {
            break;
        }
        whole.extend_from_slice(&rest[end + 2..end + 2 + size]);
        rest = &rest[end + 4 + size..];
    }
    String::from_utf8(whole).unwrap()
}
