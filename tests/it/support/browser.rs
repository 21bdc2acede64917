//! A real browser, driven by its own protocol: Chromium without a window.
//!
//! Where none is installed a test is skipped with a message, unless `BROWSER_REQUIRED` is set, as `.ci/run` does.

use std::cell::RefCell;
use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use base64::Engine;
use serde_json::{Value, json};
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// How long a page may take for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// A browser at work. It ends when this is dropped.
pub struct Browser {
    process: Child,
    connection: RefCell<Connection>,
    _profile: tempfile::TempDir,
}

/// What is said to it, and what it has said of its own accord.
struct Connection {
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    said: u64,
    /// What went wrong on its pages, by their sessions.
    log: Vec<(String, String)>,
    /// Where scripts run, the latest last.
    contexts: Vec<Value>,
}

/// An open page.
pub struct Page<'a> {
    browser: &'a Browser,
    session: String,
}

impl Browser {
    /// Starts one, if one is installed.
    pub fn start() -> Option<Browser> {
        let names = ["chromium", "chromium-browser", "google-chrome"];
        let path = std::env::var_os("PATH").unwrap_or_default();
        let place =
            |name: &str| std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file());
        let Some(program) = names.into_iter().find_map(place) else {
            assert!(std::env::var_os("BROWSER_REQUIRED").is_none(), "there is no browser among {names:?}");
            eprintln!("skipped: there is no browser among {names:?}");
            return None;
        };
        Some(Browser::launch(&program, PATIENCE).unwrap_or_else(|why| panic!("{}: {why}", program.display())))
    }

    /// Starts that one. Fails if it takes longer than that until it is ready.
    pub fn launch(program: &Path, patience: Duration) -> Result<Browser, String> {
        let profile = tempfile::tempdir().unwrap();
        let mut process = Command::new(program)
            .args("--headless=new --no-sandbox --disable-gpu --no-first-run --disable-background-networking".split(' '))
            .args("--disable-component-update --disable-sync --remote-debugging-port=0 about:blank".split(' '))
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines().map_while(Result::ok);
        let (said, address) = mpsc::channel();
        std::thread::spawn(move || {
            if let Some(address) = lines.find_map(|line| Some(line.split_once("listening on ")?.1.to_owned())) {
                let _ = said.send(address);
            }
            // What else it says is of no use, but must be taken.
            lines.for_each(drop);
        });
        let address = address.recv_timeout(patience).map_err(|_| "it does not say where it listens".to_owned());
        match address.and_then(|address| connected(&address, patience)) {
            Ok(socket) => {
                let connection = RefCell::new(Connection { socket, said: 0, log: Vec::new(), contexts: Vec::new() });
                Ok(Browser { process, connection, _profile: profile })
            }
            Err(why) => {
                let _ = process.kill();
                let _ = process.wait();
                Err(why)
            }
        }
    }

    /// Opens a page in a window of that size, and waits until it is loaded.
    pub fn open(&self, url: &str, (width, height): (u32, u32)) -> Page<'_> {
        let said = |method: &str, what: Value| self.connection.borrow_mut().say(None, method, what);
        let target = said("Target.createTarget", json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = said("Target.attachToTarget", json!({ "targetId": target, "flatten": true }));
        let page = Page { browser: self, session: attached["sessionId"].as_str().unwrap().to_owned() };
        for domain in ["Page", "Runtime", "Log"] {
            page.say(&format!("{domain}.enable"), json!({}));
        }
        page.resize(width, height);
        let failed = page.say("Page.navigate", json!({ "url": url }));
        assert!(failed["errorText"].is_null(), "{url}: {failed}");
        page.wait_for("location.href !== 'about:blank' && document.readyState === 'complete'");
        page
    }

    /// Opens a file.
    pub fn open_file(&self, path: &Path, size: (u32, u32)) -> Page<'_> {
        self.open(&format!("file://{}", path.display()), size)
    }
}

/// The connection to one that listens at an address, where each answer may take so long.
fn connected(address: &str, patience: Duration) -> Result<WebSocket<MaybeTlsStream<TcpStream>>, String> {
    let host = address.trim_start_matches("ws://").split('/').next().unwrap_or_default();
    let stream = TcpStream::connect(host).map_err(|error| format!("{address}: {error}"))?;
    stream.set_read_timeout(Some(patience)).unwrap();
    let joined = tungstenite::client(address, MaybeTlsStream::Plain(stream));
    joined.map(|(socket, _)| socket).map_err(|error| format!("it does not answer at {address}: {error}"))
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Page<'_> {
    /// What an expression of JavaScript comes to, as JSON; of a promise, what it is resolved to.
    pub fn eval(&self, expression: &str) -> Value {
        self.evaluate(expression, json!({}))
    }

    /// The same among the scripts of one of the frames in it, counted from 0.
    pub fn eval_in(&self, frame: usize, expression: &str) -> Value {
        let frame = self.say("Page.getFrameTree", json!({}))["frameTree"]["childFrames"][frame]["frame"]["id"].take();
        let is_of_frame =
            |context: &&Value| context["auxData"]["frameId"] == frame && context["auxData"]["isDefault"] == true;
        let connection = self.browser.connection.borrow();
        let context =
            connection.contexts.iter().rev().find(is_of_frame).expect("the frame has scripts")["uniqueId"].clone();
        drop(connection);
        self.evaluate(expression, json!({ "uniqueContextId": context }))
    }

    fn evaluate(&self, expression: &str, mut asked: Value) -> Value {
        asked["expression"] = json!(expression);
        (asked["awaitPromise"], asked["returnByValue"]) = (json!(true), json!(true));
        let answer = self.say("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// Waits until an expression is true.
    pub fn wait_for(&self, expression: &str) {
        self.wait(expression, |expression| self.eval(expression));
    }

    /// The same in one of the frames.
    pub fn wait_in(&self, frame: usize, expression: &str) {
        self.wait(expression, |expression| self.eval_in(frame, expression));
    }

    fn wait(&self, expression: &str, eval: impl Fn(&str) -> Value) {
        let start = Instant::now();
        while eval(&format!("!!({expression})")) != Value::Bool(true) {
            assert!(start.elapsed() < PATIENCE, "{expression} is still not true; the page said {:?}", self.log());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses a key: `ArrowRight`, ` `, `Shift+ArrowLeft`.
    pub fn key(&self, key: &str) {
        let (modifiers, key) = key.strip_prefix("Shift+").map_or((0, key), |key| (8, key));
        let text = if key.chars().count() == 1 { key } else { "" };
        let code = match key {
            "Enter" => 13,
            "Tab" => 9,
            "Escape" => 27,
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            _ => 0,
        };
        for (kind, text) in [("keyDown", text), ("keyUp", "")] {
            let kind = if kind == "keyDown" && text.is_empty() { "rawKeyDown" } else { kind };
            let mut event = json!({ "type": kind, "key": key, "modifiers": modifiers, "windowsVirtualKeyCode": code });
            if !text.is_empty() {
                event["text"] = json!(text);
            }
            self.say("Input.dispatchKeyEvent", event);
        }
    }

    /// Clicks a place in the window.
    pub fn click(&self, x: f64, y: f64) {
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.say("Input.dispatchMouseEvent", event);
        }
    }

    /// Clicks the middle of the first element that a selector finds, once it has come into view.
    pub fn click_on(&self, selector: &str) {
        let middle = self.eval(&format!(
            "(() => {{ const found = document.querySelector({selector:?}); found.scrollIntoView({{ block: 'center' }}); \
             const {{ left, top, width, height }} = found.getBoundingClientRect(); return [left + width / 2, top + height / 2]; }})()"
        ));
        self.click(middle[0].as_f64().unwrap(), middle[1].as_f64().unwrap());
    }

    /// Makes the window another size.
    pub fn resize(&self, width: u32, height: u32) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.say("Emulation.setDeviceMetricsOverride", size);
    }

    /// Shows the page as on a system that is dark, or light.
    pub fn dark(&self, is_dark: bool) {
        let value = if is_dark { "dark" } else { "light" };
        self.say(
            "Emulation.setEmulatedMedia",
            json!({ "features": [{ "name": "prefers-color-scheme", "value": value }] }),
        );
    }

    /// Writes a picture of the whole page, as PNG.
    pub fn screenshot(&self, path: &Path) {
        let taken = self.say("Page.captureScreenshot", json!({ "captureBeyondViewport": true }));
        let png = base64::engine::general_purpose::STANDARD.decode(taken["data"].as_str().unwrap()).unwrap();
        std::fs::write(path, png).unwrap();
    }

    /// What went wrong on it: errors and warnings on its console, and what it threw.
    pub fn log(&self) -> Vec<String> {
        let connection = self.browser.connection.borrow();
        let own = connection.log.iter().filter(|(session, _)| *session == self.session);
        own.map(|(_, text)| text.clone()).collect()
    }

    /// Nothing has gone wrong on it.
    pub fn assert_quiet(&self) {
        // What it has said until now comes before the answer.
        self.eval("0");
        assert_eq!(self.log(), Vec::<String>::new());
    }

    /// Says something of the protocol to it, and waits for the answer.
    pub fn say(&self, method: &str, what: Value) -> Value {
        self.browser.connection.borrow_mut().say(Some(&self.session), method, what)
    }
}

impl Connection {
    fn say(&mut self, session: Option<&str>, method: &str, what: Value) -> Value {
        self.said += 1;
        let mut message = json!({ "id": self.said, "method": method, "params": what });
        if let Some(session) = session {
            message["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(message.to_string())).unwrap();
        loop {
            let Message::Text(text) = self.socket.read().expect("the browser answers") else { continue };
            let mut message: Value = serde_json::from_str(&text).unwrap();
            if message["id"] == self.said {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            self.note(&message);
        }
    }

    fn note(&mut self, message: &Value) {
        let what = &message["params"];
        if message["method"] == "Runtime.executionContextCreated" {
            self.contexts.push(what["context"].clone());
        }
        let is_bad = |level: &Value| ["error", "warning", "assert"].iter().any(|bad| level == bad);
        let text = match message["method"].as_str() {
            Some("Runtime.exceptionThrown") => what["exceptionDetails"].to_string(),
            Some("Runtime.consoleAPICalled") if is_bad(&what["type"]) => what["args"].to_string(),
            Some("Log.entryAdded") if is_bad(&what["entry"]["level"]) => what["entry"].to_string(),
            _ => return,
        };
        self.log.push((message["sessionId"].as_str().unwrap_or_default().to_owned(), text));
    }
}
