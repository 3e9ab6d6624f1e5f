import "./style.css";
import { showOperator } from "./operator";
import { showParticipant } from "./participant";

const root = document.getElementById("console") as HTMLElement;
if (location.pathname === "/participant") showParticipant(root);
else showOperator(root);
